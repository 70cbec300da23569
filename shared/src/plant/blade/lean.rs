//! Conversion between the lean of a link and its direction. Uses polynomials instead of trigonometric functions, so that every machine gets the same
//! bits.

use std::f32::consts::PI;

/// Square of the lean (rad²) of a link that hangs straight down; larger ones count as this.
pub const HANGING_RAD2: f32 = PI * PI;

/// Taylor coefficients of cos √t.
pub const COSINE: [f32; 9] = [
    1.0,
    -1.0 / 2.0,
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
    1.0 / 20_922_789_888_000.0,
];

/// Taylor coefficients of sin √t / √t.
pub const SINC: [f32; 9] = [
    1.0,
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5_040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
    1.0 / 355_687_428_096_000.0,
];

/// Taylor coefficients of atan √t / √t.
pub const ARCTANGENT: [f32; 7] = [1.0, -1.0 / 3.0, 1.0 / 5.0, -1.0 / 7.0, 1.0 / 9.0, -1.0 / 11.0, 1.0 / 13.0];

#[inline(always)]
fn polynomial<const N: usize>(coefficients: &[f32; N], t: f32) -> f32 {
    let mut sum = coefficients[N - 1];
    for i in (0..N - 1).rev() {
        sum = sum * t + coefficients[i];
    }
    sum
}

/// Unit vector (X, up, Z) of a link with a lean given as a vector on the ground (rad): upright at 0, level at π/2, hanging at π and beyond. Error at
/// most 2e-6.
#[inline(always)]
pub fn direction(lean_rad: [f32; 2]) -> [f32; 3] {
    let [x, z] = lean_rad;
    let t = (x * x + z * z).min(HANGING_RAD2);
    let aside = polynomial(&SINC, t);
    [x * aside, polynomial(&COSINE, t), z * aside]
}

/// Lean (rad) of a unit vector, the inverse of [`direction`]; error at most 1e-5. A vector straight down gives a lean of π along X.
#[inline(always)]
pub fn lean_of(direction: [f32; 3]) -> [f32; 2] {
    let [x, up, z] = direction;
    let aside = (x * x + z * z).sqrt();
    // Tangent of half the angle, by the quotient without cancellation; then of an eighth of it.
    let mut tangent = if up < 0.0 { (1.0 - up) / aside.max(1e-9) } else { aside / (1.0 + up) };
    for _ in 0..2 {
        tangent /= 1.0 + (1.0 + tangent * tangent).sqrt();
    }
    let angle = 8.0 * tangent * polynomial(&ARCTANGENT, tangent * tangent);
    if aside < 1e-9 && up < 0.0 {
        return [angle, 0.0];
    }
    let per_aside = angle / aside.max(1e-9);
    [x * per_aside, z * per_aside]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn directions_are_those_of_sine_and_cosine(angle in 0.0..std::f64::consts::PI, heading in 0.0_f64..6.3) {
            let lean = [angle * heading.cos(), angle * heading.sin()];
            let found = direction(lean.map(|v| v as f32)).map(f64::from);
            let wanted = [angle.sin() * heading.cos(), angle.cos(), angle.sin() * heading.sin()];
            prop_assert!((0..3).all(|i| (found[i] - wanted[i]).abs() < 2e-6), "{found:?} instead of {wanted:?}");
        }

        #[test]
        fn a_lean_is_found_again(angle in 0.0..0.9999 * PI, heading in 0.0_f32..6.3) {
            let lean = [angle * heading.cos(), angle * heading.sin()];
            let found = lean_of(direction(lean));
            prop_assert!((0..2).all(|i| (found[i] - lean[i]).abs() < 1e-5), "{found:?} instead of {lean:?}");
        }
    }

    #[test]
    fn a_lean_beyond_half_a_turn_hangs() {
        assert!((direction([9.0, 0.0])[1] + 1.0).abs() < 1e-5);
        let [x, z] = lean_of([0.0, -1.0, 0.0]);
        assert!((x - PI).abs() < 1e-5 && z == 0.0);
    }
}
