//! The mirrored fields at a place.

use super::{Mirror, WindCodes};
use glam::Vec3;
use shared::bend::wind_lean_rad;
use shared::wire::quantise::{dust, omega_rad_per_s, theta_rad, wind_m_per_s};

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
        let kind = usize::from(land.kinds().at(x_m, z_m));
        let bend_rad = land.scene().kinds()[kind].wind_bend_rad;
        let [wind, field] = [wind_lean_rad([wind.x, wind.z], bend_rad), self.field_lean_rad(x_m, z_m)];
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

    /// Wind of the cell at `place_m` (m/s), a height over the sea; the box of cells repeats along X and Z, or is another's for each patch.
    /// Zero before the first wind has come.
    pub fn wind_at(&self, place_m: Vec3) -> Vec3 {
        Vec3::from_array(self.at_cells(place_m, |wind, index| wind.planes().map(|plane| wind_m_per_s(plane[index]))))
    }

    /// Concentration of dust of the cell at `place_m`, a height over the sea, as [`wind_at`](Self::wind_at).
    pub fn dust_at(&self, place_m: Vec3) -> f32 {
        let [concentration] = self.at_cells(place_m, |wind, index| [wind.dust().map_or(0.0, |codes| dust(codes[index]))]);
        concentration
    }

    /// What `value` says of the wind in the cell at `place_m`, by the cell's index; 0 before the first wind has come.
    fn at_cells<const N: usize>(&self, place_m: Vec3, value: impl Fn(&WindCodes, usize) -> [f32; N]) -> [f32; N] {
        let (Some(land), Some(wind)) = (self.land(), self.wind()) else { return [0.0; N] };
        let (spacing_m, cells) = (land.scene().wind.spacing_m, wind.cells());
        let height_m = place_m.y - self.ground_m(place_m.x, place_m.z);
        let across = |m: f32, axis: usize| ((m / spacing_m[axis]).floor() as i64).rem_euclid(i64::from(cells[axis])) as usize;
        let layer = ((height_m / spacing_m[1]).max(0.0) as usize).min(cells[1] as usize - 1);
        let [width, layers] = [cells[0], cells[1]].map(|count| count as usize);
        land.tiles().blend([place_m.x, place_m.z], |[x_m, z_m]| value(wind, across(x_m, 0) + width * (layer + layers * across(z_m, 2))))
    }
}
