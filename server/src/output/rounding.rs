//! Rounding of values to a stated absolute error, so that they compress well.
//!
//! Values become the nearest multiples of a power of two, whose low bits are zero: plain numbers for every reader, without a codec that it would have to know.

/// Distance between the values that remain: the largest power of two of at most twice the error.
pub(super) fn step(error: f32) -> f32 {
    // Removes all bits but those of the exponent.
    f32::from_bits((2.0 * error).to_bits() & 0x7f80_0000)
}

/// The multiple of `step`, a power of two, that is nearest to a value. The error is at most half a step; NaN, infinities and values too large for a multiple stay.
pub(super) fn rounded(value: f32, step: f32) -> f32 {
    let steps = value / step;
    if steps.is_finite() { steps.round_ties_even() * step } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn rounded_values_are_within_the_error(value in -1e6_f32..1e6, error in 1e-6_f32..1e3) {
            let step = step(error);
            prop_assert!(step <= 2.0 * error && 2.0 * step > 2.0 * error);
            let found = rounded(value, step);
            prop_assert!((f64::from(found) - f64::from(value)).abs() <= f64::from(error), "{found}");
            prop_assert_eq!(found / step, (found / step).round());
        }
    }

    #[test]
    fn the_error_is_reached() {
        assert_eq!((step(0.01), step(0.5), step(1.0)), (0.015_625, 1.0, 2.0));
        assert_eq!(rounded(0.5, 1.0), 0.0);
        assert_eq!(rounded(1.5, 1.0), 2.0);
        assert!(rounded(f32::NAN, 1.0).is_nan() && rounded(f32::INFINITY, 1.0) == f32::INFINITY && rounded(3e38, 1e-6) == 3e38);
    }
}
