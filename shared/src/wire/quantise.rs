//! Quantisation of the fields to 8 bits, with error bounds.
//!
//! θ and wind are linear. ω and dust are companded by a square root, so that weak bends keep their direction and thin dust is kept.

use multiversion::multiversion;
use std::f32::consts::TAU;
use std::num::NonZeroU8;

/// θ at code ±127 (rad). The field is the bend minus the wind's lean: grass flattened against the wind deviates by up to a right angle plus
/// [`wind_bend_rad`](crate::scene::Grass::wind_bend_rad), 3.07 rad.
pub const THETA_FULL_RAD: f32 = std::f32::consts::PI;

/// |ω| of a component at code ±127 (rad/s); larger values saturate.
pub const OMEGA_FULL_RAD_PER_S: f32 = 80.0;

/// Wind component at code ±127 (m/s); larger values saturate.
pub const WIND_FULL_M_PER_S: f32 = 31.75;

/// Code of a bending angle; error at most `THETA_FULL_RAD / 254` (0.0124 rad) within ±[`THETA_FULL_RAD`].
#[inline]
pub fn theta_code(theta_rad: f32) -> i8 {
    linear_code(theta_rad, THETA_FULL_RAD)
}

/// [`theta_code`] of a row of cells.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
pub fn theta_codes(thetas_rad: &[f32], codes: &mut [i8]) {
    codes.iter_mut().zip(thetas_rad).for_each(|(code, theta_rad)| *code = theta_code(*theta_rad));
}

/// Bending angle of a code (rad).
pub fn theta_rad(code: i8) -> f32 {
    linear_value(code, THETA_FULL_RAD)
}

/// Code of a component of the bending velocity: `127·√(|ω|/full)`, rounded, with its sign. The error of `√(|ω|/full)` is at most
/// 1/254, so that of ω at most `full·(|code| + ¼)/127²` within ±[`OMEGA_FULL_RAD_PER_S`].
#[inline]
pub fn omega_code(omega_rad_per_s: f32) -> i8 {
    let size = (omega_rad_per_s.abs() * (127.0 * 127.0 / OMEGA_FULL_RAD_PER_S)).sqrt();
    rounded(size.copysign(omega_rad_per_s))
}

/// [`omega_code`] of a row of cells.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
pub fn omega_codes(omegas_rad_per_s: &[f32], codes: &mut [i8]) {
    codes.iter_mut().zip(omegas_rad_per_s).for_each(|(code, omega_rad_per_s)| *code = omega_code(*omega_rad_per_s));
}

/// Component of the bending velocity of a code (rad/s).
pub fn omega_rad_per_s(code: i8) -> f32 {
    let fraction = f32::from(code) / 127.0;
    fraction * fraction.abs() * OMEGA_FULL_RAD_PER_S
}

/// Code of a wind component; error at most 0.125 m/s within ±[`WIND_FULL_M_PER_S`].
#[inline]
pub fn wind_code(m_per_s: f32) -> i8 {
    linear_code(m_per_s, WIND_FULL_M_PER_S)
}

/// Wind component of a code (m/s).
pub fn wind_m_per_s(code: i8) -> f32 {
    linear_value(code, WIND_FULL_M_PER_S)
}

/// Concentration of dust at code 127; more saturates, and negative values count as 0. A gust that releases 1/s leaves about 2 where it is thickest.
pub const DUST_FULL: f32 = 16.0;

/// Code of a concentration of dust, 0..=127: `127·√(c/full)`, rounded. The error of c is at most `full·(code + ¼)/127²` within
/// 0..=[`DUST_FULL`]: 0.03 at a concentration of 1.
#[inline]
pub fn dust_code(concentration: f32) -> i8 {
    rounded((concentration.max(0.0) * (127.0 * 127.0 / DUST_FULL)).sqrt())
}

/// Concentration of dust of a code; 0 for negative codes.
pub fn dust(code: i8) -> f32 {
    let fraction = f32::from(code.max(0)) / 127.0;
    fraction * fraction * DUST_FULL
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
fn linear_code(value: f32, full: f32) -> i8 {
    rounded(value * (127.0 / full))
}

/// The nearest integer within ±127, ties to even; −127 for NaN. Without branches or library calls, so that loops over cells vectorise: adding 1.5·2²³
/// leaves the integer in the lowest bits of the sum.
#[inline(always)]
fn rounded(value: f32) -> i8 {
    const SHIFT: f32 = 12_582_912.0;
    let bounded = if value > -127.0 { value } else { -127.0 };
    let bounded = if bounded < 127.0 { bounded } else { 127.0 };
    (bounded + SHIFT).to_bits() as i8
}

fn linear_value(code: i8, full: f32) -> f32 {
    f32::from(code) / 127.0 * full
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn theta_stays_within_its_bound(theta in -THETA_FULL_RAD..=THETA_FULL_RAD) {
            prop_assert!((theta_rad(theta_code(theta)) - theta).abs() <= THETA_FULL_RAD / 254.0 * 1.0001);
        }

        #[test]
        fn omega_stays_within_its_bound(fraction in -1.0_f32..=1.0) {
            let omega = fraction * fraction.abs() * OMEGA_FULL_RAD_PER_S;
            let code = omega_code(omega);
            let bound = OMEGA_FULL_RAD_PER_S * (f32::from(code).abs() + 0.25) / (127.0 * 127.0);
            prop_assert!((omega_rad_per_s(code) - omega).abs() <= bound * 1.001, "{omega} -> {code}");
        }

        #[test]
        fn wind_stays_within_its_bound(wind in -WIND_FULL_M_PER_S..=WIND_FULL_M_PER_S) {
            prop_assert!((wind_m_per_s(wind_code(wind)) - wind).abs() <= 0.125 * 1.0001);
        }

        #[test]
        fn dust_stays_within_its_bound(fraction in 0.0_f32..=1.0) {
            let concentration = fraction * fraction * DUST_FULL;
            let code = dust_code(concentration);
            let bound = DUST_FULL * (f32::from(code) + 0.25) / (127.0 * 127.0);
            prop_assert!((dust(code) - concentration).abs() <= bound * 1.001, "{concentration} -> {code}");
        }
    }

    proptest! {
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
    fn vectors_without_a_heading_have_a_code() {
        for vector in [[0.0; 2], [1.0, -1e-9], [f32::NAN, 1.0], [f32::MAX, 0.0]] {
            assert_eq!(heading_code(vector), NonZeroU8::MAX, "{vector:?}");
        }
        let off = heading_rad(heading_code([(TAU / 511.0).cos(), (TAU / 511.0).sin()])) - TAU - TAU / 511.0;
        assert!(off.abs() > 0.99 * TAU / 511.0, "the bound is reached");
    }

    #[test]
    fn the_bounds_are_reached() {
        let half_step = THETA_FULL_RAD / 254.0;
        assert!((theta_rad(theta_code(0.999 * half_step)) - 0.999 * half_step).abs() > 0.99 * half_step);
        assert_eq!(theta_code(10.0), 127);
        assert_eq!(omega_code(-1e9), -127);
        assert_eq!(wind_code(f32::INFINITY), 127);
        assert_eq!(wind_code(f32::NAN), -127);
        let between = DUST_FULL * (20.499 / 127.0_f32).powi(2);
        assert!((dust(dust_code(between)) - between).abs() > 0.99 * DUST_FULL * 20.25 / (127.0 * 127.0));
        assert_eq!([-3.0, 0.0, DUST_FULL, 1e9].map(dust_code), [0, 0, 127, 127]);
        assert_eq!(dust(-5), 0.0);
    }
}
