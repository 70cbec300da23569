//! Equilibrium lean of grass in a steady wind.

/// Wind speed beyond which grass bends no further (m/s): it streamlines, and the drag no longer grows.
pub const BEND_SATURATES_M_PER_S: f32 = 10.0;

/// Lean (rad, as a vector along X and Z) that a steady wind sustains: `bend_rad·(min(|u|, 10)/10)²` along the wind. Drag is proportional to the
/// square of the speed and balances the grass's stiffness.
///
/// Its twin on the GPU is `lean_of_wind` in `inputs/wind.wgsl`.
pub fn wind_lean_rad(wind_m_per_s: [f32; 2], bend_rad: f32) -> [f32; 2] {
    let [u, w] = wind_m_per_s;
    let speed = (u * u + w * w).sqrt();
    let fraction = speed.min(BEND_SATURATES_M_PER_S) / BEND_SATURATES_M_PER_S;
    let per_speed = bend_rad * fraction * fraction / speed.max(1e-3);
    [u * per_speed, w * per_speed]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grass_leans_with_the_wind_up_to_its_limit() {
        let length = |[x, z]: [f32; 2]| (x * x + z * z).sqrt();
        assert_eq!(wind_lean_rad([0.0, 0.0], 0.5), [0.0, 0.0]);
        let [x, z] = wind_lean_rad([6.0, 0.0], 0.5);
        assert!((x - 0.18).abs() < 1e-6 && z == 0.0, "half a radian times 0.6²");
        assert!((length(wind_lean_rad([-3.0, 4.0], 0.8)) - 0.2).abs() < 1e-6);
        assert!((length(wind_lean_rad([30.0, 40.0], 0.8)) - 0.8).abs() < 1e-6);
    }
}
