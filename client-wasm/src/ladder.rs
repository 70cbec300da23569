//! What automatic quality gives up to keep its budget, rung by rung: at the highest level of detail first resolution, down to half of the pixels; then detail;
//! last resolution again, down to a quarter of the pixels.

use std::f32::consts::FRAC_1_SQRT_2;

/// Least fraction of the resolution along each side.
pub const LEAST_RESOLUTION: f32 = 0.5;
/// Fraction of the resolution at which detail changes.
const STEADY_RESOLUTION: f32 = FRAC_1_SQRT_2;
/// Steps of the resolution: each creates new textures, and changes the number of pixels by less than the dead band of the controller.
const RESOLUTION_STEPS: f32 = 32.0;
/// Rungs below the coarsest level of detail.
pub const RUNGS_BELOW: f32 = 1.0;
/// Rungs above the highest level of detail.
const RUNGS_ABOVE: f32 = 1.0;

/// What a frame is drawn with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rung {
    /// Level of detail, from 0.
    pub level: f32,
    /// Fraction of the quality's resolution along each side.
    pub resolution: f32,
}

impl Rung {
    /// The rung at a height of 0..=[`top`], where the highest level of detail is `highest_level`. The number of pixels doubles with each of the lowest and the
    /// highest rungs.
    pub fn at(height: f32, highest_level: f32) -> Self {
        let level = (height - RUNGS_BELOW).clamp(0.0, highest_level);
        let pixels_log2 = if height < RUNGS_BELOW { height - RUNGS_BELOW } else { (height - RUNGS_BELOW - highest_level).max(0.0) };
        let resolution = STEADY_RESOLUTION * (0.5 * pixels_log2).exp2();
        Self { level, resolution: rounded(resolution) }
    }
}

/// A fraction of the resolution, in steps of 1/32 from [`LEAST_RESOLUTION`] to 1.
pub fn rounded(resolution: f32) -> f32 {
    (resolution.clamp(LEAST_RESOLUTION, 1.0) * RESOLUTION_STEPS).round() / RESOLUTION_STEPS
}

/// Height of the highest rung.
pub fn top(highest_level: f32) -> f32 {
    RUNGS_BELOW + highest_level + RUNGS_ABOVE
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budget::{FrameBudget, FrameTime};

    #[test]
    fn each_rung_up_draws_more_and_the_ends_are_least_and_most() {
        for highest_level in [0.0, 1.0, 3.0] {
            let rungs: Vec<Rung> = (0..=100).map(|at| Rung::at(at as f32 * 0.01 * top(highest_level), highest_level)).collect();
            assert_eq!(rungs[0], Rung { level: 0.0, resolution: LEAST_RESOLUTION });
            assert!(rungs[100].level == highest_level && (rungs[100].resolution - 1.0).abs() < 1e-6);
            for pair in rungs.windows(2) {
                let rises = [pair[1].level - pair[0].level, pair[1].resolution - pair[0].resolution];
                assert!(rises.iter().all(|rise| (0.0..0.06).contains(rise)), "{pair:?}");
            }
        }
    }

    #[test]
    fn detail_is_given_up_at_half_of_the_pixels() {
        for height in [1.01, 1.5, 3.0, 3.99] {
            let rung = Rung::at(height, 3.0);
            assert!((rung.resolution.powi(2) - 0.5).abs() < 0.02 && (rung.level - (height - 1.0)).abs() < 1e-6, "{rung:?}");
        }
    }

    /// Frames whose cost is in part that of pixels, and which are only as fine as the steps of the resolution, neither hunt nor leave the budget unused.
    #[test]
    fn automatic_quality_settles_on_a_rung() {
        let (highest_level, budget_secs) = (3.0, 1.0 / 30.0);
        let cost_secs = |height: f32, [pixels_secs, slope, fixed_secs]: [f32; 3]| {
            let rung = Rung::at(height, highest_level);
            fixed_secs + pixels_secs * rung.resolution.powi(2) * (slope * rung.level).exp()
        };
        for device in
            [[0.060, 0.3, 0.002], [0.045, 0.3, 0.010], [0.030, 0.3, 0.002], [0.030, 0.6, 0.010], [0.020, 0.3, 0.002], [0.012, 0.5, 0.004]]
        {
            for begin in [0.0, 1.5, top(highest_level)] {
                let mut budget = FrameBudget::new(budget_secs, begin, top(highest_level));
                let mut heights = vec![];
                for _ in 0..3600 {
                    let work_secs = cost_secs(budget.level(), device);
                    budget.record(FrameTime { work_secs, interval_secs: work_secs.max(1.0 / 60.0), waited: false });
                    heights.push(budget.level());
                }
                let settled = &heights[2400..];
                let (low, high) = settled.iter().fold((f32::MAX, f32::MIN), |(low, high), &height| (low.min(height), high.max(height)));
                let used = cost_secs(budget.level(), device) / budget_secs;
                assert!(high - low < 0.3, "{device:?} from {begin}: between {low} and {high}");
                assert!((0.85..=1.05).contains(&used), "{device:?} from {begin}: {used} of the budget");
            }
        }
    }
}
