//! Wind profile between the ground and the lowest wind cells.

/// Height (m) above which the solver's wind is used unchanged.
pub const FREE_WIND_M: f32 = 2.0;
/// Lowest height of the profile, as a fraction of [`FREE_WIND_M`]; below it the wind is constant.
pub const LEAST_WIND_HEIGHT: f32 = 0.02;

/// Wind speed at a height above the ground (m), relative to the wind of the solver's cells: the power law `(h / 2 m)^¼` from 4 cm up to 2 m, 1 above.
///
/// Dynamic pressure scales with its square, as in `pressure_at` of `underbrush.wgsl`.
pub fn near_ground_fraction(above_m: f32) -> f32 {
    (above_m / FREE_WIND_M).clamp(LEAST_WIND_HEIGHT, 1.0).sqrt().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wind_decreases_towards_the_ground() {
        assert_eq!([2.0, 3.0, f32::INFINITY].map(near_ground_fraction), [1.0; 3]);
        assert!((near_ground_fraction(0.125) - 0.5).abs() < 1e-6);
        assert_eq!(near_ground_fraction(-1.0), near_ground_fraction(0.04));
    }
}
