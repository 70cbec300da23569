//! The mirrored fields at a place.

use super::Mirror;
use glam::Vec3;
use shared::bend::wind_lean_rad;
use shared::wire::quantise::{omega_rad_per_s, theta_rad, wind_m_per_s};

impl Mirror {
    /// Height of the land at `(x_m, z_m)` (m); 0 before the scene has come.
    pub fn ground_m(&self, x_m: f32, z_m: f32) -> f32 {
        self.land().map_or(0.0, |land| land.heights().height_m(x_m, z_m))
    }

    /// Bending angle of the grass at `(x_m, z_m)` (rad): of what the bend field and the wind hold together. The field counts as at rest
    /// outside the world and where it is unknown.
    pub fn theta_at(&self, x_m: f32, z_m: f32) -> f32 {
        let Some(land) = self.land() else { return 0.0 };
        let wind = self.wind_at(Vec3::new(x_m, self.ground_m(x_m, z_m), z_m));
        let [wind, field] = [wind_lean_rad([wind.x, wind.z], land.scene().grass.wind_bend_rad), self.field_lean_rad(x_m, z_m)];
        let [x, z] = [0, 1].map(|axis| wind[axis] + field[axis]);
        (x * x + z * z).sqrt()
    }

    /// Lean of the cell at `(x_m, z_m)` in the bend field alone (rad, as a vector along X and Z).
    fn field_lean_rad(&self, x_m: f32, z_m: f32) -> [f32; 2] {
        let sample = || {
            let layout = self.land()?.layout();
            let patch = layout.patch_at(x_m, z_m)?;
            let [corner_x_m, corner_z_m] = layout.corner_m(patch);
            let cell = |m: f32| ((m / layout.cell_m) as usize).min(layout.cells as usize - 1);
            let index = cell(x_m - corner_x_m) + cell(z_m - corner_z_m) * layout.cells as usize;
            let [theta, x, z] = self.patch(patch)?.planes().map(|plane| plane.get(index).copied());
            let omega = [omega_rad_per_s(x?), omega_rad_per_s(z?)];
            let speed = (omega[0] * omega[0] + omega[1] * omega[1]).sqrt();
            (speed > 0.0).then(|| omega.map(|omega| omega / speed * theta_rad(theta.unwrap_or_default())))
        };
        sample().unwrap_or_default()
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
