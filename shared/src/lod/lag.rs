//! Delay of a plant's upper segments (Chen & Johan §4.5): they follow the lowest segment's bend with a lag, which is shorter while the grass rises.

use crate::scene::Grass;
use std::f32::consts::FRAC_PI_2;

/// Number of earlier states of the field that [`LagWay::History`](crate::scene::LagWay::History) keeps.
pub const PASTS: usize = 3;

/// Delay of one kind of grass. Twin: `trailing_lean` in `inputs/bend_atlas.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lag {
    /// γ of the topmost segment (s).
    pub tip_secs: f32,
    /// Fraction of γ while the grass rises.
    pub recovery_fraction: f32,
    /// Number of segments, at least 1.
    pub segments: u32,
    /// Speed of θ in still grass, c₀ (m/s), Chen & Johan Eq. (4).
    pub c0_m_per_s: f32,
    /// Increase of that speed with the bending velocity, μ (m/rad).
    pub mu_m_per_rad: f32,
}

impl From<&Grass> for Lag {
    fn from(grass: &Grass) -> Self {
        Self {
            tip_secs: grass.lag_secs,
            recovery_fraction: grass.recovery_lag_share,
            segments: grass.segments.max(1),
            c0_m_per_s: grass.waves.c0_m_per_s,
            mu_m_per_rad: grass.waves.mu_m_per_rad,
        }
    }
}

impl Lag {
    /// γ of a segment (s), counted from 0 at the root: 0 for the lowest, largest for the topmost, evenly spaced between.
    pub fn secs(&self, segment: u32) -> f32 {
        self.tip_secs * segment as f32 / (self.segments - 1).max(1) as f32
    }

    /// Lean (rad, as a vector on the ground) of a segment with the lag `lag_secs`, where `earlier` gives the lean of the lowest segment that many
    /// seconds ago (Chen & Johan Eq. 7). If the lean was larger then, the grass is rising, and the segment follows with the smaller lag.
    pub fn lean_rad(&self, lag_secs: f32, earlier: impl Fn(f32) -> [f32; 2]) -> [f32; 2] {
        let square = |[x, z]: [f32; 2]| x * x + z * z;
        let then = earlier(lag_secs);
        if square(then) <= square(earlier(0.0)) { then } else { earlier(lag_secs * self.recovery_fraction) }
    }

    /// Distance that a bend with bending velocity `omega_rad_per_s` has travelled in `lag_secs` (m, as a vector on the ground), Chen & Johan Eq. (9):
    /// the state that the root had then is there now. The lag is at most π/(2|ω|), the range of the paper; at ω = 0 the distance is 0.
    pub fn reached_m(&self, omega_rad_per_s: [f32; 2], lag_secs: f32) -> [f32; 2] {
        let [x, z] = omega_rad_per_s;
        let speed = (x * x + z * z).sqrt();
        if speed < 1e-6 {
            return [0.0; 2];
        }
        let c_m_per_s = self.c0_m_per_s + self.mu_m_per_rad * speed;
        let far_m = c_m_per_s * lag_secs.min(FRAC_PI_2 / speed);
        omega_rad_per_s.map(|omega| omega / speed * far_m)
    }
}

/// Weights of the newest state and of [`PASTS`] earlier ones with increasing ages (s) for the state `lag_secs` ago: linear interpolation between the
/// two nearest; beyond the oldest, the oldest.
///
/// ```
/// use prairie_core::lod::history_weights;
/// assert_eq!(history_weights([0.125, 0.25, 0.5], 0.0), [1.0, 0.0, 0.0, 0.0]);
/// assert_eq!(history_weights([0.125, 0.25, 0.5], 0.3125), [0.0, 0.0, 0.75, 0.25]);
/// assert_eq!(history_weights([0.125, 0.25, 0.5], 9.0), [0.0, 0.0, 0.0, 1.0]);
/// ```
pub fn history_weights(ages_secs: [f32; PASTS], lag_secs: f32) -> [f32; PASTS + 1] {
    let mut weights = [0.0; PASTS + 1];
    let mut younger_secs = 0.0;
    for (i, age_secs) in ages_secs.into_iter().enumerate() {
        if lag_secs <= age_secs {
            let fraction = (lag_secs - younger_secs) / (age_secs - younger_secs).max(1e-6);
            (weights[i], weights[i + 1]) = (1.0 - fraction, fraction);
            return weights;
        }
        younger_secs = age_secs;
    }
    weights[PASTS] = 1.0;
    weights
}

/// Joints of a plant (m: X, height and Z relative to its root) above the root: the tops of its segments, all of equal length, each with its own lean
/// of `leans_rad` from upright (Chen & Johan Fig. 5). `ground_m` is the height of the ground at a position relative to that at the root; joints below
/// the ground are moved up to it.
pub fn joints_m<const N: usize>(height_m: f32, leans_rad: [[f32; 2]; N], ground_m: impl Fn([f32; 2]) -> f32) -> [[f32; 3]; N] {
    let length_m = height_m / N as f32;
    let mut at = [0.0_f32; 3];
    leans_rad.map(|[x, z]| {
        let angle = (x * x + z * z).sqrt();
        let aside = length_m * angle.sin() / angle.max(1e-6);
        at = [at[0] + x * aside, at[1] + length_m * angle.cos(), at[2] + z * aside];
        at[1] = at[1].max(ground_m([at[0], at[2]]));
        at
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn lag() -> Lag {
        Lag { tip_secs: 0.3, recovery_fraction: 0.4, segments: 4, c0_m_per_s: 3.0, mu_m_per_rad: 0.5 }
    }

    /// Lean of a bump of 0.8 rad and some 2 m that travels along `direction` at the wave speed of grass of `lag` bending at 0.6 rad/s.
    fn wave(lag: &Lag, direction: [f32; 2], [x, z]: [f32; 2], t_secs: f32) -> [f32; 2] {
        let c_m_per_s = lag.c0_m_per_s + lag.mu_m_per_rad * 0.6;
        let along_m = x * direction[0] + z * direction[1] - c_m_per_s * t_secs;
        direction.map(|d| d * 0.8 * (-along_m * along_m).exp())
    }

    proptest! {
        #[test]
        fn looking_upwind_and_looking_back_agree_on_a_travelling_wave(angle in 0.0f32..6.3, x in -3.0f32..3.0, z in -3.0f32..3.0, segment in 0_u32..4) {
            let (lag, direction) = (lag(), [angle.cos(), angle.sin()]);
            let back = lag.lean_rad(lag.secs(segment), |secs| wave(&lag, direction, [x, z], -secs));
            let upwind = lag.lean_rad(lag.secs(segment), |secs| {
                let [dx, dz] = lag.reached_m(direction.map(|d| d * 0.6), secs);
                wave(&lag, direction, [x + dx, z + dz], 0.0)
            });
            prop_assert!((0..2).all(|axis| (back[axis] - upwind[axis]).abs() < 1e-4), "{back:?} and {upwind:?}");
        }

        #[test]
        fn no_joint_is_below_a_slope(leans in proptest::array::uniform4([-1.6f32..1.6, -1.6f32..1.6]), slope in [-1.0f32..1.0, -1.0f32..1.0]) {
            let ground_m = |[x, z]: [f32; 2]| slope[0] * x + slope[1] * z;
            for [x, y, z] in joints_m(1.2, leans, ground_m) {
                prop_assert!(y >= ground_m([x, z]), "({x}, {y}, {z})");
            }
        }

        #[test]
        fn weights_of_the_past_are_shares_of_its_age(secs in 0.0f32..0.5) {
            let ages = [0.08, 0.21, 0.5];
            let weights = history_weights(ages, secs);
            prop_assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-6 && weights.iter().all(|w| (0.0..=1.0).contains(w)));
            let age: f32 = ages.iter().zip(&weights[1..]).map(|(age, weight)| age * weight).sum();
            prop_assert!((age - secs).abs() < 1e-5);
        }
    }

    #[test]
    fn upper_segments_trail_and_rising_ones_trail_less() {
        let lag = lag();
        assert_eq!([0, 1, 3].map(|segment| lag.secs(segment)), [0.0, 0.1, 0.3]);
        // A lean that grows or falls by 1 rad/s.
        let lean = |rate: f32| lag.lean_rad(0.3, |secs| [0.5 - rate * secs, 0.0])[0];
        assert!((lean(1.0) - 0.2).abs() < 1e-6 && (lean(-1.0) - 0.62).abs() < 1e-6);
    }

    #[test]
    fn one_segment_has_no_lag() {
        let stiff = Lag { segments: 1, ..lag() };
        assert_eq!(stiff.secs(0), 0.0);
        assert_eq!(stiff.lean_rad(stiff.secs(0), |secs| [0.7 - secs, 0.1]), [0.7, 0.1]);
    }

    #[test]
    fn nothing_is_looked_for_beyond_a_quarter_turn() {
        let fast = lag().reached_m([0.0, -30.0], 0.3);
        assert!(fast[0] == 0.0 && (fast[1] + 18.0 * FRAC_PI_2 / 30.0).abs() < 1e-6, "{fast:?}");
        assert_eq!(lag().reached_m([0.0; 2], 0.3), [0.0; 2]);
    }

    #[test]
    fn segments_of_a_plant_keep_their_length_where_they_are_free() {
        let joints = joints_m(0.9, [[0.2, 0.0], [0.5, 0.1], [0.9, 0.3]], |_| -9.0);
        let mut below = [0.0; 3];
        for joint in joints {
            let length = (0..3).map(|axis| (joint[axis] - below[axis]).powi(2)).sum::<f32>().sqrt();
            assert!((length - 0.3).abs() < 1e-6);
            below = joint;
        }
    }
}
