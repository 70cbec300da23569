//! Intensity of a flow primitive: a function of time that runs outwards from its centre (Bakay §3.2).
//!
//! An intensity depends on the time alone and keeps no state. Only +, −, ×, ÷ and remainders are used, so that it has the same bits everywhere.

mod spline;

use super::config::error::{ConfigError, above_zero, at_least_zero, check};
pub use spline::Spline;

/// Fraction by which a pulse may be longer than its period, since decimal fractions are rounded.
const ROUNDING: f64 = 1e-6;

/// Intensity as a function of the time (s) since the start; 0 before it, except for [`Intensity::Steady`].
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Intensity {
    /// 1 at all times.
    #[default]
    Steady,
    /// Linear rise from 0 to 1, hold, parabolic fall to 0: with no hold the envelope of the random gusts. Its slope jumps at the ends of the rise.
    Gust(Pulse),
    /// Rise and fall by one cubic polynomial each, `s²(3 − 2s)`: continuous with its slope, which is 0 at both ends.
    Cubic(Pulse),
    /// `sin²(πt/T)`, from 0 to 1 and back in each period T; smooth.
    Periodic {
        /// Period T (s); above 0, at most 1e6.
        period_secs: f32,
    },
    /// A curve through points of one's own, the only one that may be below 0.
    Spline(Spline),
}

/// Times of a pulse, of which at least one is above 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pulse {
    /// Duration of the rise (s), 0 to 1e6; with 0 it begins at its peak.
    pub attack_secs: f32,
    /// Time at the peak (s), 0 to 1e6.
    pub hold_secs: f32,
    /// Duration of the fall (s), 0 to 1e6; with 0 it ends at its peak.
    pub fall_secs: f32,
    /// Time from one pulse to the next (s), at least the sum of the others; 0 for a single pulse.
    pub period_secs: f32,
}

/// Motion of an intensity away from the centre: at a distance it is that of the centre some time ago.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Front {
    /// Speed (m/s), 0 to 1e6. Default 0: the intensity is the same everywhere.
    pub speed_m_per_s: f32,
    /// Width (m) of the rings around the centre within which the intensity is the same, the animation steps of Bakay §3.2; 0 to 1e6. Default 0: it is continuous.
    pub step_m: f32,
}

/// A moment of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Time of the solver (s), by which primitives drift.
    pub secs: f64,
    /// Time since the start of the intensities (s).
    pub intensity_secs: f64,
}

impl Intensity {
    /// Intensity at a time (s) since the start.
    ///
    /// ```
    /// use prairie_wind::intensity::{Intensity, Pulse};
    ///
    /// let gust = Intensity::Gust(Pulse { attack_secs: 1.0, hold_secs: 0.5, fall_secs: 4.0, period_secs: 10.0 });
    /// assert_eq!([-1.0, 0.0, 0.5, 1.25, 3.5, 6.0, 10.5].map(|secs| gust.level(secs)), [0.0, 0.0, 0.5, 1.0, 0.25, 0.0, 0.5]);
    /// ```
    pub fn level(&self, secs: f64) -> f64 {
        if secs < 0.0 && !self.is_steady() {
            return 0.0;
        }
        match self {
            Self::Steady => 1.0,
            Self::Gust(pulse) => pulse.level(secs, |risen| risen, |left| left * left),
            Self::Cubic(pulse) => pulse.level(secs, smooth_step, smooth_step),
            Self::Periodic { period_secs } => {
                let period_secs = f64::from(*period_secs);
                sin_squared(secs % period_secs / period_secs)
            }
            Self::Spline(spline) => spline.level(secs),
        }
    }

    /// Whether it is 1 at all times.
    pub fn is_steady(&self) -> bool {
        matches!(self, Self::Steady)
    }

    pub(super) fn validate(&self, path: &str) -> Result<(), ConfigError> {
        match self {
            Self::Steady => Ok(()),
            Self::Gust(pulse) | Self::Cubic(pulse) => pulse.validate(path),
            Self::Periodic { period_secs } => validate_period(path, *period_secs),
            Self::Spline(spline) => spline.validate(path),
        }
    }
}

/// Checks the period (s) of an intensity that repeats.
fn validate_period(path: &str, period_secs: f32) -> Result<(), ConfigError> {
    above_zero(&format!("{path}.period_secs"), period_secs)
}

impl Pulse {
    /// Level at a time (s) since the start of the first pulse, 0 or more, by the functions of a rise from 0 to 1 and of what is left of a fall.
    fn level(&self, secs: f64, rise: fn(f64) -> f64, fall: fn(f64) -> f64) -> f64 {
        let [attack_secs, hold_secs, fall_secs, period_secs] =
            [self.attack_secs, self.hold_secs, self.fall_secs, self.period_secs].map(f64::from);
        let age_secs = if period_secs > 0.0 { secs % period_secs } else { secs };
        let falling_secs = age_secs - (attack_secs + hold_secs);
        if age_secs < attack_secs {
            rise(age_secs / attack_secs)
        } else if falling_secs < 0.0 {
            1.0
        } else if falling_secs < fall_secs {
            fall(1.0 - falling_secs / fall_secs)
        } else {
            0.0
        }
    }

    fn validate(&self, path: &str) -> Result<(), ConfigError> {
        at_least_zero(&format!("{path}.attack_secs"), self.attack_secs)?;
        at_least_zero(&format!("{path}.hold_secs"), self.hold_secs)?;
        at_least_zero(&format!("{path}.fall_secs"), self.fall_secs)?;
        at_least_zero(&format!("{path}.period_secs"), self.period_secs)?;
        let length_secs: f64 = [self.attack_secs, self.hold_secs, self.fall_secs].map(f64::from).iter().sum();
        check(length_secs > 0.0, format!("{path}.attack_secs"), self.attack_secs, "above 0, without a hold and a fall")?;
        let period_secs = f64::from(self.period_secs);
        let fits = period_secs == 0.0 || length_secs <= period_secs * (1.0 + ROUNDING);
        check(fits, format!("{path}.period_secs"), self.period_secs, "0, or at least attack_secs + hold_secs + fall_secs")
    }
}

impl Front {
    /// Time (s) that it takes to a distance (m) from the centre.
    ///
    /// ```
    /// use prairie_wind::intensity::Front;
    ///
    /// let front = Front { speed_m_per_s: 10.0, step_m: 4.0 };
    /// assert_eq!([3.9, 4.0, 11.0].map(|distance_m| front.delay_secs(distance_m)), [0.0, 0.4, 0.8]);
    /// assert_eq!(Front::default().delay_secs(11.0), 0.0);
    /// ```
    pub fn delay_secs(&self, distance_m: f64) -> f64 {
        let [speed_m_per_s, step_m] = [self.speed_m_per_s, self.step_m].map(f64::from);
        if speed_m_per_s == 0.0 {
            return 0.0;
        }
        let ring_m = if step_m > 0.0 { (distance_m / step_m).floor() * step_m } else { distance_m };
        ring_m / speed_m_per_s
    }

    pub(super) fn validate(&self, path: &str) -> Result<(), ConfigError> {
        at_least_zero(&format!("{path}.speed_m_per_s"), self.speed_m_per_s)?;
        at_least_zero(&format!("{path}.step_m"), self.step_m)
    }
}

/// The cubic polynomial that rises from 0 to 1 with a slope of 0 at both ends.
fn smooth_step(s: f64) -> f64 {
    s * s * (3.0 - 2.0 * s)
}

/// `sin²(π·turn)` for a turn of 0 to 1, to 1e-13: the Taylor polynomial of the sine of degree 17 over a quarter of its period.
fn sin_squared(turn: f64) -> f64 {
    let angle_rad = std::f64::consts::PI * turn.min(1.0 - turn);
    let square = angle_rad * angle_rad;
    let terms = (1..=8).rev().map(|n| f64::from(2 * n * (2 * n + 1)));
    let sine = angle_rad * terms.fold(1.0, |rest, divisor| 1.0 - square / divisor * rest);
    sine * sine
}

#[cfg(test)]
mod tests;
