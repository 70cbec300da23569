//! The wind at any place above the ground, as plants and balls feel it.

use super::Weather;
use glam::Vec3;
use shared::wind::share_near_ground;

impl Weather {
    /// Wind (m/s) at a place: X, height above the ground, Z (m). Trilinear between the middles of the cells; beyond them as in the nearest, around the box where it
    /// wraps, and weaker close to the [ground](share_near_ground).
    pub fn wind_m_per_s(&self, [x_m, above_m, z_m]: [f32; 3]) -> [f32; 3] {
        let free = self.tiles.blend([x_m, z_m], |[x_m, z_m]| self.in_box([x_m, above_m, z_m]).to_array());
        free.map(|speed| speed * share_near_ground(above_m))
    }

    /// Speed (m/s) that the wind exceeds nowhere up to a height above the ground (m).
    pub fn strongest_m_per_s(&self, height_m: f32) -> f32 {
        let [nx, ny, nz] = self.config.cells;
        let layers = ((height_m / self.config.spacing_m[1] - 0.5).ceil().max(0.0) as usize).min(ny - 1) + 1;
        let columns = (0..nz).flat_map(|k| &self.velocities[nx * ny * k..][..nx * layers]);
        columns.map(|velocity| velocity.length_squared()).fold(0.0, f32::max).sqrt()
    }

    fn in_box(&self, at_m: [f32; 3]) -> Vec3 {
        let (cells, wraps) = (self.config.cells, self.wraps);
        let axes: [([usize; 2], f32); 3] = std::array::from_fn(|axis| {
            let at = at_m[axis] / self.config.spacing_m[axis] - 0.5;
            let (low, count) = (at.floor(), cells[axis] as i64);
            let cell = |n: i64| (if wraps[axis] { n.rem_euclid(count) } else { n.clamp(0, count - 1) }) as usize;
            ([cell(low as i64), cell((low as i64).saturating_add(1))], at - low)
        });
        let [([west, east], u), ([down, up], v), ([north, south], w)] = axes;
        let velocity = |i: usize, j: usize, k: usize| self.velocities[i + cells[0] * (j + cells[1] * k)];
        let along = |j: usize, k: usize| velocity(west, j, k).lerp(velocity(east, j, k), u);
        let across = |k: usize| along(down, k).lerp(along(up, k), v);
        across(north).lerp(across(south), w)
    }
}
