//! Periodic curve through points, which never leaves the range of their values.

use super::validate_period;
use crate::config::error::{ConfigError, check};

/// Cubic Hermite spline through points of time and intensity, repeated with its period. Monotone between points (Fritsch & Carlson 1980): the slope at a point is that
/// of the parabola through it and its neighbours, where that neither overshoots nor turns.
///
/// Continuous with its slope. Third order in the distance of the points where the curve is smooth and monotone, second order at its extrema.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    period_secs: f32,
    points: Vec<[f32; 2]>,
    slopes_per_s: Vec<f64>,
}

/// Minimum and maximum number of points.
const POINTS: std::ops::RangeInclusive<usize> = 2..=32;
/// Maximum magnitude of the intensity at a point.
const MAX_LEVEL: f32 = 10.0;

impl Spline {
    /// The spline of a period (s), above 0, through 2 to 32 `points` of time (s) and intensity: times ascend from 0 to below the period, intensities are -10 to 10.
    pub fn new(period_secs: f32, points: Vec<[f32; 2]>) -> Self {
        let mut spline = Self { period_secs, slopes_per_s: Vec::new(), points };
        spline.slopes_per_s = (0..spline.points.len()).map(|n| spline.slope_per_s(n)).collect();
        spline
    }

    /// Duration (s) and rise of the piece from point `n` to the next; the first point follows the last.
    fn piece(&self, n: usize) -> [f64; 2] {
        let [from_secs, from] = self.points[n].map(f64::from);
        let [to_secs, to] = self.points[(n + 1) % self.points.len()].map(f64::from);
        let turn_secs = if n + 1 == self.points.len() { f64::from(self.period_secs) } else { 0.0 };
        [to_secs + turn_secs - from_secs, to - from]
    }

    /// Slope (1/s) at point `n`: at most thrice that of the chords on both sides, and 0 between chords that rise and fall.
    fn slope_per_s(&self, n: usize) -> f64 {
        let last = self.points.len() - 1;
        let [[before_secs, before], [after_secs, after]] = [self.piece(if n == 0 { last } else { n - 1 }), self.piece(n)];
        let [before, after] = [before / before_secs, after / after_secs];
        if before * after <= 0.0 {
            return 0.0;
        }
        let parabola = (after_secs * before + before_secs * after) / (before_secs + after_secs);
        let steepest = 3.0 * before.abs().min(after.abs());
        parabola.abs().min(steepest).copysign(parabola)
    }

    /// Level at a time (s) since the start, 0 or more.
    pub(super) fn level(&self, secs: f64) -> f64 {
        let period_secs = f64::from(self.period_secs);
        let mut phase_secs = secs % period_secs;
        if phase_secs < f64::from(self.points[0][0]) {
            phase_secs += period_secs;
        }
        let n = self.points.partition_point(|&[point_secs, _]| f64::from(point_secs) <= phase_secs) - 1;
        let ([from_secs, from], [piece_secs, rise]) = (self.points[n].map(f64::from), self.piece(n));
        let [slope, next_slope] = [n, (n + 1) % self.points.len()].map(|n| self.slopes_per_s[n] * piece_secs);
        let s = (phase_secs - from_secs) / piece_secs;
        let value = from + s * (slope + s * (3.0 * rise - 2.0 * slope - next_slope + s * (slope + next_slope - 2.0 * rise)));
        // Only rounding takes it out of the range of the two points.
        value.clamp(from.min(from + rise), from.max(from + rise))
    }

    pub(super) fn validate(&self, path: &str) -> Result<(), ConfigError> {
        validate_period(path, self.period_secs)?;
        let points = format!("{path}.points");
        check(POINTS.contains(&self.points.len()), &points, format!("a list of {}", self.points.len()), "2 to 32 points")?;
        let mut before_secs = -1.0;
        for (n, &[secs, level]) in self.points.iter().enumerate() {
            let is_next = secs >= 0.0 && secs > before_secs && secs < self.period_secs;
            check(is_next, format!("{points}[{n}][0]"), secs, "0 to below the period, above the time of the point before")?;
            check((-MAX_LEVEL..=MAX_LEVEL).contains(&level), format!("{points}[{n}][1]"), level, "-10 to 10")?;
            before_secs = secs;
        }
        Ok(())
    }
}
