//! Motion of the gusts that the cells do not resolve: the mean wind of one layer carries them, and its friction velocity drives them.

use super::settings::ROUGHNESS_M;
use glam::{DVec2, Vec3};
use prairie_core::wind::turbulence::{REFERENCE_M, VON_KARMAN};
use prairie_core::wire::TurbulenceState;
use prairie_wind::Config;

/// The layer of cells whose mean wind carries the gusts.
pub(super) struct Carrier {
    cells: [usize; 3],
    layer: usize,
    /// Friction velocity over the speed of the mean wind, in the logarithmic profile.
    friction: f64,
}

impl Carrier {
    /// The layer of a solver's box that is nearest to [`REFERENCE_M`].
    pub(super) fn new(config: &Config) -> Self {
        let [_, layers, _] = config.cells;
        let layer = ((REFERENCE_M / config.spacing_m[1] - 0.5).round().max(0.0) as usize).min(layers - 1);
        let height_m = (layer as f32 + 0.5) * config.spacing_m[1];
        let logarithm = libm::log(f64::from(height_m / ROUGHNESS_M)).max(1.0);
        Self { cells: config.cells, layer, friction: f64::from(VON_KARMAN) / logarithm }
    }

    /// Advances the gusts by `secs` in the wind of all cells (m/s), x fastest, then y, then z.
    pub(super) fn advance(&self, state: &mut TurbulenceState, velocities: &[Vec3], secs: f64) {
        let [nx, ny, nz] = self.cells;
        let rows = (0..nz).map(|k| &velocities[nx * (self.layer + ny * k)..][..nx]);
        let sum = rows.flatten().map(|velocity| DVec2::new(velocity.x.into(), velocity.z.into())).fold(DVec2::ZERO, |sum, wind| sum + wind);
        let mean = sum / (nx * nz) as f64;
        let friction = self.friction * mean.length();
        state.travel_m = [state.travel_m[0] + mean.x * secs, state.travel_m[1] + mean.y * secs];
        state.path_m += friction * secs;
        state.friction_m_per_s = friction as f32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gusts_travel_with_the_mean_wind_of_the_layer_at_ten_metres() {
        let config = Config { cells: [4, 8, 4], spacing_m: [8.0, 2.0, 8.0], ..Config::default() };
        let carrier = Carrier::new(&config);
        assert_eq!(carrier.layer, 5, "its centre is at 11 m");
        let wind = |at: usize| if at / 4 % 8 == 5 { Vec3::new(6.0 + (at % 2) as f32 * 4.0, 3.0, -6.0) } else { Vec3::splat(30.0) };
        let velocities: Vec<_> = (0..128).map(wind).collect();
        let mut state = TurbulenceState { travel_m: [100.0, 0.0], ..TurbulenceState::default() };
        carrier.advance(&mut state, &velocities, 0.5);
        assert_eq!(state.travel_m, [104.0, -3.0]);
        let friction = 0.4 * 10.0 / (11.0_f64 / 0.05).ln();
        assert!((f64::from(state.friction_m_per_s) - friction).abs() < 1e-6 && (state.path_m - 0.5 * friction).abs() < 1e-6);
    }
}
