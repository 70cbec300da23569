//! The mirrored fields at a place.

use super::Mirror;
use glam::Vec3;
use shared::wire::quantise::{theta_rad, wind_m_per_s};

impl Mirror {
    /// Height of the land at `(x_m, z_m)` (m); 0 before the scene has come.
    pub fn ground_m(&self, x_m: f32, z_m: f32) -> f32 {
        self.land().map_or(0.0, |land| land.heights().height_m(x_m, z_m))
    }

    /// Bending angle of the cell at `(x_m, z_m)` (rad); 0 at rest, outside the world, and where the field is unknown.
    pub fn theta_at(&self, x_m: f32, z_m: f32) -> f32 {
        let sample = || {
            let layout = self.land()?.layout();
            let patch = layout.patch_at(x_m, z_m)?;
            let [corner_x_m, corner_z_m] = layout.corner_m(patch);
            let cell = |m: f32| ((m / layout.cell_m) as usize).min(layout.cells as usize - 1);
            let index = cell(x_m - corner_x_m) + cell(z_m - corner_z_m) * layout.cells as usize;
            Some(theta_rad(*self.patch(patch)?.planes()[0].get(index)?))
        };
        sample().unwrap_or(0.0)
    }

    /// Wind of the cell at `place_m` (m/s), whose height counts from the land; the box of cells repeats along X and Z. Zero before
    /// the first wind has come.
    pub fn wind_at(&self, place_m: Vec3) -> Vec3 {
        let sample = || {
            let spacing_m = self.land()?.scene().wind.spacing_m;
            let wind = self.wind()?;
            let cells = wind.cells();
            let height_m = place_m.y - self.ground_m(place_m.x, place_m.z);
            let across = |m: f32, axis: usize| ((m / spacing_m[axis]).floor() as i64).rem_euclid(i64::from(cells[axis])) as usize;
            let layer = ((height_m / spacing_m[1]).max(0.0) as usize).min(cells[1] as usize - 1);
            let [width, layers] = [cells[0], cells[1]].map(|count| count as usize);
            let index = across(place_m.x, 0) + width * (layer + layers * across(place_m.z, 2));
            let [u, v, w] = wind.planes().map(|plane| plane.get(index).map_or(0.0, |&code| wind_m_per_s(code)));
            Some(Vec3::new(u, v, w))
        };
        sample().unwrap_or(Vec3::ZERO)
    }
}
