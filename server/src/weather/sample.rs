//! Wind at any position above the ground.

use super::Weather;
use prairie_core::wind::near_ground_fraction;

impl Weather {
    /// Wind (m/s) at a position: X, height above the ground, Z (m). Trilinear between cell centres, extended by the nearest cell or periodically where the box
    /// wraps, and reduced close to the [ground](near_ground_fraction).
    pub fn wind_m_per_s(&self, [x_m, above_m, z_m]: [f32; 3]) -> [f32; 3] {
        let free =
            self.tiles.blend([x_m, z_m], |[x_m, z_m]| self.grid.trilinear([x_m, above_m, z_m], |cell| self.velocities[cell].to_array()));
        free.map(|speed| speed * near_ground_fraction(above_m))
    }

    /// Upper bound of the wind speed (m/s) up to a height above the ground (m).
    pub fn strongest_m_per_s(&self, height_m: f32) -> f32 {
        let [nx, ny, nz] = self.config.cells;
        let layers = ((height_m / self.config.spacing_m[1] - 0.5).ceil().max(0.0) as usize).min(ny - 1) + 1;
        let columns = (0..nz).flat_map(|k| &self.velocities[nx * ny * k..][..nx * layers]);
        columns.map(|velocity| velocity.length_squared()).fold(0.0, f32::max).sqrt()
    }
}
