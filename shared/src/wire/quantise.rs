//! Quantisation of the streamed fields to whole codes, with error bounds that the scene sets.
//!
//! θ and wind are linear. ω and dust are companded by a square root, so that weak bends keep their direction and thin dust is kept. Codes have 16 bits, which
//! no value that the simulation can reach exceeds: at the default steps ±571 rad, ±5 million rad/s, ±8191 m/s. A larger value gets the largest code.

use crate::scene::Stream;
use multiversion::multiversion;
use serde::{Deserialize, Serialize};
use std::f32::consts::{PI, TAU};
use std::num::NonZeroU8;

/// Largest code; the smallest is its negative.
pub const CODE_LIMIT: i16 = i16::MAX;

/// Step between neighbouring codes of a difference in the depth of snow (m). The error is at most half a step.
pub const SNOW_STEP_M: f32 = 0.002;
/// The step in micrometres, [quanta](crate::grass::snow::DEPTH_QUANTUM_M) of depth.
const SNOW_STEP_UM: i64 = 2000;

/// Code of a difference in the depth of snow, in micrometres.
pub fn snow_code(difference_um: i64) -> i16 {
    let rounded = (difference_um + difference_um.signum() * SNOW_STEP_UM / 2) / SNOW_STEP_UM;
    rounded.clamp(-i64::from(CODE_LIMIT), CODE_LIMIT.into()) as i16
}

/// Difference in the depth of snow of a code (m).
pub fn snow_m(code: i16) -> f32 {
    f32::from(code) * SNOW_STEP_M
}

/// Steps between neighbouring codes: those of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CodeSteps {
    /// Step of θ (rad).
    pub theta_rad: f32,
    /// Step of the square root of a component of ω (√(rad/s)).
    pub omega_root: f32,
    /// Step of a component of the wind (m/s).
    pub wind_m_per_s: f32,
    /// Step of the square root of the concentration of dust.
    pub dust_root: f32,
}

impl From<&Stream> for CodeSteps {
    fn from(stream: &Stream) -> Self {
        let Stream { theta_error_deg, omega_error_rad_per_s, wind_error_m_per_s, dust_error } = *stream;
        Self {
            theta_rad: theta_error_deg * (2.0 * PI / 180.0),
            omega_root: omega_error_rad_per_s,
            wind_m_per_s: 2.0 * wind_error_m_per_s,
            dust_root: dust_error,
        }
    }
}

impl Default for CodeSteps {
    /// Steps of a scene with the default errors.
    fn default() -> Self {
        Self::from(&Stream::default())
    }
}

impl CodeSteps {
    /// Code of a bending angle (rad); error at most half a step.
    pub fn theta_code(&self, theta_rad: f32) -> i16 {
        linear_code(theta_rad, 1.0 / self.theta_rad)
    }

    /// [`theta_code`](Self::theta_code) of a row of cells.
    pub fn theta_codes(&self, thetas_rad: &[f32], codes: &mut [i16]) {
        linear_codes(thetas_rad, 1.0 / self.theta_rad, codes);
    }

    /// Bending angle of a code (rad).
    pub fn theta_rad(&self, code: i16) -> f32 {
        f32::from(code) * self.theta_rad
    }

    /// Code of a component of the bending velocity (rad/s): its root, with its sign, in steps. The error of ω is at most `step·√|ω| + step²/4`.
    pub fn omega_code(&self, omega_rad_per_s: f32) -> i16 {
        root_code(omega_rad_per_s, 1.0 / self.omega_root)
    }

    /// [`omega_code`](Self::omega_code) of a row of cells.
    pub fn omega_codes(&self, omegas_rad_per_s: &[f32], codes: &mut [i16]) {
        root_codes(omegas_rad_per_s, 1.0 / self.omega_root, codes);
    }

    /// Component of the bending velocity of a code (rad/s).
    pub fn omega_rad_per_s(&self, code: i16) -> f32 {
        let root = f32::from(code) * self.omega_root;
        root * root.abs()
    }

    /// Code of a wind component (m/s); error at most half a step.
    pub fn wind_code(&self, m_per_s: f32) -> i16 {
        linear_code(m_per_s, 1.0 / self.wind_m_per_s)
    }

    /// Wind component of a code (m/s).
    pub fn wind_m_per_s(&self, code: i16) -> f32 {
        f32::from(code) * self.wind_m_per_s
    }

    /// Code of a concentration of dust: its root in steps; negative values count as 0. The error of c is at most `step·√c + step²/4`.
    pub fn dust_code(&self, concentration: f32) -> i16 {
        root_code(concentration.max(0.0), 1.0 / self.dust_root)
    }

    /// Concentration of dust of a code; 0 for negative codes.
    pub fn dust(&self, code: i16) -> f32 {
        let root = f32::from(code.max(0)) * self.dust_root;
        root * root
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw", "x86_64+avx2"))]
fn linear_codes(values: &[f32], per_step: f32, codes: &mut [i16]) {
    codes.iter_mut().zip(values).for_each(|(code, value)| *code = linear_code(*value, per_step));
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw", "x86_64+avx2"))]
fn root_codes(values: &[f32], per_step: f32, codes: &mut [i16]) {
    codes.iter_mut().zip(values).for_each(|(code, value)| *code = root_code(*value, per_step));
}

/// Code of the heading of a vector on the ground (X and Z), in 255ths of a turn from +X towards +Z; a whole turn is 255, so that 0 is free to mean
/// "none". Error at most τ/510 (0.0124 rad). The zero vector gets the heading of +X.
pub fn heading_code([x, z]: [f32; 2]) -> NonZeroU8 {
    let steps = (z.atan2(x) * (255.0 / TAU)).round().rem_euclid(255.0);
    NonZeroU8::new(steps as u8).unwrap_or(NonZeroU8::MAX)
}

/// Heading of a code (rad) from +X towards +Z, up to a whole turn.
pub fn heading_rad(code: NonZeroU8) -> f32 {
    f32::from(code.get()) * (TAU / 255.0)
}

#[inline(always)]
fn linear_code(value: f32, per_step: f32) -> i16 {
    rounded(value * per_step)
}

#[inline(always)]
fn root_code(value: f32, per_step: f32) -> i16 {
    rounded((value.abs().sqrt() * per_step).copysign(value))
}

/// The nearest integer within ±[`CODE_LIMIT`], ties to even; the smallest code for NaN. Without branches or library calls, so that loops over cells vectorise:
/// adding 1.5·2²³ leaves the integer in the lowest bits of the sum.
#[inline(always)]
fn rounded(value: f32) -> i16 {
    const SHIFT: f32 = 12_582_912.0;
    const LIMIT: f32 = CODE_LIMIT as f32;
    let bounded = if value > -LIMIT { value } else { -LIMIT };
    let bounded = if bounded < LIMIT { bounded } else { LIMIT };
    (bounded + SHIFT).to_bits() as i16
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn steps() -> impl Strategy<Value = CodeSteps> {
        let stream = |(theta_error_deg, omega_error_rad_per_s, wind_error_m_per_s, dust_error)| Stream {
            theta_error_deg,
            omega_error_rad_per_s,
            wind_error_m_per_s,
            dust_error,
        };
        prop_oneof![
            Just(CodeSteps::default()),
            (0.05_f32..5.0, 0.01_f32..1.0, 0.01_f32..1.0, 0.005_f32..0.5).prop_map(move |errors| CodeSteps::from(&stream(errors))),
        ]
    }

    /// Error bound of a value whose root is rounded to whole steps.
    fn root_bound(value: f32, step: f32) -> f32 {
        step * value.abs().sqrt() + 0.25 * step * step
    }

    proptest! {
        #[test]
        fn values_stay_within_their_bounds(
            steps in steps(),
            theta in -4.0_f32..4.0,
            root in -30.0_f32..30.0,
            wind in -120.0_f32..120.0,
            dust in 0.0_f32..100.0,
        ) {
            let omega = root * root.abs();
            let rounding = 1.0 + 1e-4;
            prop_assert!((steps.theta_rad(steps.theta_code(theta)) - theta).abs() <= 0.5 * steps.theta_rad * rounding);
            prop_assert!((steps.omega_rad_per_s(steps.omega_code(omega)) - omega).abs() <= root_bound(omega, steps.omega_root) * rounding);
            prop_assert!((steps.wind_m_per_s(steps.wind_code(wind)) - wind).abs() <= 0.5 * steps.wind_m_per_s * rounding);
            prop_assert!((steps.dust(steps.dust_code(dust)) - dust).abs() <= root_bound(dust, steps.dust_root) * rounding);
        }

        #[test]
        fn rows_have_the_codes_of_their_cells(values in proptest::collection::vec(-1e6_f32..1e6, 0..70)) {
            let steps = CodeSteps::default();
            let mut codes = vec![0; values.len()];
            steps.theta_codes(&values, &mut codes);
            prop_assert!(codes.iter().zip(&values).all(|(code, value)| *code == steps.theta_code(*value)));
            steps.omega_codes(&values, &mut codes);
            prop_assert!(codes.iter().zip(&values).all(|(code, value)| *code == steps.omega_code(*value)));
        }

        #[test]
        fn headings_stay_within_their_bound(heading in 0.0..TAU, length in 1e-6_f32..1e6) {
            let found = heading_rad(heading_code([length * heading.cos(), length * heading.sin()]));
            let off = (found - heading + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
            prop_assert!(off.abs() <= TAU / 510.0 * 1.0001 + 1e-6, "{heading} has become {found}");
        }

        #[test]
        fn any_code_is_that_of_its_heading(code in 1..=u8::MAX) {
            let code = NonZeroU8::new(code).expect("above 0");
            prop_assert_eq!(heading_code([heading_rad(code).cos(), heading_rad(code).sin()]), code);
        }
    }

    #[test]
    fn depths_of_snow_stay_within_half_a_step_and_reach_it() {
        let error_m = |um: i64| f64::from(snow_m(snow_code(um))) - um as f64 * 1e-6;
        let errors_m = (-200_000..200_000).step_by(33).map(|um| error_m(um).abs());
        assert!(errors_m.fold(0.0, f64::max) <= 0.5 * f64::from(SNOW_STEP_M) * 1.0001);
        assert!(error_m(2999).abs() > 0.99 * 0.5 * f64::from(SNOW_STEP_M) && error_m(-999).abs() > 0.99 * 0.5 * f64::from(SNOW_STEP_M));
        assert_eq!([i64::MAX / 2, i64::MIN / 2].map(snow_code), [CODE_LIMIT, -CODE_LIMIT]);
    }

    #[test]
    fn vectors_without_a_heading_have_a_code() {
        for vector in [[0.0; 2], [1.0, -1e-9], [f32::NAN, 1.0], [f32::MAX, 0.0]] {
            assert_eq!(heading_code(vector), NonZeroU8::MAX, "{vector:?}");
        }
        let off = heading_rad(heading_code([(TAU / 511.0).cos(), (TAU / 511.0).sin()])) - TAU - TAU / 511.0;
        assert!(off.abs() > 0.99 * TAU / 511.0, "the bound is reached");
    }

    #[test]
    fn the_bounds_are_reached_and_only_absurd_values_have_the_largest_code() {
        let steps = CodeSteps::default();
        assert!((steps.theta_rad - 1.0_f32.to_radians()).abs() < 1e-7 && steps.wind_m_per_s == 0.25);
        let close = 0.999 * 0.5 * steps.theta_rad;
        assert!((steps.theta_rad(steps.theta_code(close)) - close).abs() > 0.99 * 0.5 * steps.theta_rad);
        let between = (20.499 * steps.dust_root).powi(2);
        assert!((steps.dust(steps.dust_code(between)) - between).abs() > 0.97 * root_bound(between, steps.dust_root));
        assert!(steps.theta_code(500.0) < CODE_LIMIT && steps.omega_code(1e6) < CODE_LIMIT && steps.wind_code(8000.0) < CODE_LIMIT);
        assert_eq!(
            [steps.theta_code(f32::INFINITY), steps.omega_code(-1e9), steps.wind_code(f32::NAN)],
            [CODE_LIMIT, -CODE_LIMIT, -CODE_LIMIT]
        );
        assert_eq!([-3.0, 0.0].map(|dust| steps.dust_code(dust)), [0, 0]);
        assert_eq!(steps.dust(-5), 0.0);
    }
}
