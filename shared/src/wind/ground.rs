//! The wind close to the ground, below the wind's cells.

/// Height (m) from which on the wind is that of its cells.
const FREE_M: f32 = 2.0;
/// Share of that height below which the air is as still as there.
const LEAST_SHARE: f32 = 0.02;

/// Share of the wind that blows so high above the ground (m), down among the plants: `(h/2 m)^¼`, a quarter-power law; at most 1, and at least as at 4 cm.
///
/// Pressures go with its square, as in `pressure_at` of `underbrush.wgsl`.
pub fn share_near_ground(above_m: f32) -> f32 {
    (above_m / FREE_M).clamp(LEAST_SHARE, 1.0).sqrt().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_wind_falls_off_towards_the_ground() {
        assert_eq!([2.0, 3.0, f32::INFINITY].map(share_near_ground), [1.0; 3]);
        assert!((share_near_ground(0.125) - 0.5).abs() < 1e-6);
        assert_eq!(share_near_ground(-1.0), share_near_ground(0.04));
    }
}
