//! Point samples of the mirrored fields: the value of the cell that holds the point, without interpolation.

use super::fields::WindCodes;
use super::mirror::Mirror;
use glam::Vec3;
use prairie_core::bend::wind_lean_rad;
use prairie_core::wire::quantise::{dust, omega_rad_per_s, theta_rad, wind_m_per_s};

impl Mirror {
    /// Elevation of the ground at `(x_m, z_m)` (m); 0 before the scene has arrived.
    pub fn ground_m(&self, x_m: f32, z_m: f32) -> f32 {
        self.decoded_scene().map_or(0.0, |decoded| decoded.heights().height_m(x_m, z_m))
    }

    /// Bending angle of the grass at `(x_m, z_m)` (rad), from bend field and wind together. The bend field counts as at rest outside the world and where it
    /// is unknown.
    pub fn theta_at(&self, x_m: f32, z_m: f32) -> f32 {
        let Some(decoded) = self.decoded_scene() else { return 0.0 };
        let wind = self.wind_at(Vec3::new(x_m, self.ground_m(x_m, z_m), z_m));
        let kind = usize::from(decoded.kinds().at(x_m, z_m));
        let bend_rad = decoded.scene().kinds()[kind].wind_bend_rad;
        let [wind, field] = [wind_lean_rad([wind.x, wind.z], bend_rad), self.field_lean_rad(x_m, z_m)];
        let [x, z] = [0, 1].map(|axis| wind[axis] + field[axis]);
        (x * x + z * z).sqrt()
    }

    /// Lean of the bend field's cell at `(x_m, z_m)` (rad, vector along X and Z).
    fn field_lean_rad(&self, x_m: f32, z_m: f32) -> [f32; 2] {
        let sample = || {
            let layout = self.decoded_scene()?.layout();
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

    /// Wind of the cell at `position_m` (m/s), where `y` is an elevation above sea level. The wind domain is tiled along X and Z as the scene says.
    /// Zero before the first wind frame.
    pub fn wind_at(&self, position_m: Vec3) -> Vec3 {
        Vec3::from_array(self.at_cell(position_m, |wind, index| wind.planes().map(|plane| wind_m_per_s(plane[index]))))
    }

    /// Dust concentration of the cell at `position_m`; see [`wind_at`](Self::wind_at).
    pub fn dust_at(&self, position_m: Vec3) -> f32 {
        let [concentration] = self.at_cell(position_m, |wind, index| [wind.dust().map_or(0.0, |codes| dust(codes[index]))]);
        concentration
    }

    /// `value` of the wind cell at `position_m`, given the cell's index; 0 before the first wind frame.
    fn at_cell<const N: usize>(&self, position_m: Vec3, value: impl Fn(&WindCodes, usize) -> [f32; N]) -> [f32; N] {
        let (Some(decoded), Some(wind)) = (self.decoded_scene(), self.wind()) else { return [0.0; N] };
        let (spacing_m, cells) = (decoded.scene().wind.spacing_m, wind.cells());
        let height_m = position_m.y - self.ground_m(position_m.x, position_m.z);
        let across = |m: f32, axis: usize| ((m / spacing_m[axis]).floor() as i64).rem_euclid(i64::from(cells[axis])) as usize;
        let layer = ((height_m / spacing_m[1]).max(0.0) as usize).min(cells[1] as usize - 1);
        let [width, layers] = [cells[0], cells[1]].map(|count| count as usize);
        decoded
            .tiles()
            .blend([position_m.x, position_m.z], |[x_m, z_m]| value(wind, across(x_m, 0) + width * (layer + layers * across(z_m, 2))))
    }
}
