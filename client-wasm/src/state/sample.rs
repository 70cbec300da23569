//! Point samples of the mirrored fields, by the rules of the core.

use super::mirror::Mirror;
use glam::Vec3;
use prairie_core::bend::{Bend, field_lean_at};

impl Mirror {
    /// Elevation (m) of the surface that cameras stay above at `(x_m, z_m)`: undisturbed snow, or the ground; 0 before the scene has arrived.
    pub fn surface_m(&self, x_m: f32, z_m: f32) -> f32 {
        self.ground_m(x_m, z_m) + self.decoded_scene().map_or(0.0, |decoded| decoded.scene().snow.depth_m)
    }

    /// Elevation of the ground at `(x_m, z_m)` (m); 0 before the scene has arrived.
    pub fn ground_m(&self, x_m: f32, z_m: f32) -> f32 {
        self.decoded_scene().map_or(0.0, |decoded| decoded.heights().height_m(x_m, z_m))
    }

    /// Lean of the grass at `(x_m, z_m)` (rad, vector along X and Z) in the newest frame: bend field and wind together. The bend field counts as at rest where
    /// it is unknown. Zero before the scene has arrived.
    pub fn lean_at(&self, x_m: f32, z_m: f32) -> [f32; 2] {
        let [wind, field] = [self.wind_field().map_or([0.0; 2], |wind| wind.lean_at([x_m, z_m])), self.field_lean_at(x_m, z_m)];
        [0, 1].map(|axis| wind[axis] + field[axis])
    }

    /// Bending angle of the grass at `(x_m, z_m)` (rad): the length of [`lean_at`](Self::lean_at).
    pub fn theta_at(&self, x_m: f32, z_m: f32) -> f32 {
        let [x, z] = self.lean_at(x_m, z_m);
        (x * x + z * z).sqrt()
    }

    /// Lean of the bend field alone at `(x_m, z_m)` (rad, vector along X and Z).
    pub fn field_lean_at(&self, x_m: f32, z_m: f32) -> [f32; 2] {
        let Some(decoded) = self.decoded_scene() else { return [0.0; 2] };
        field_lean_at(decoded.layout(), [x_m, z_m], |patch, cell| {
            let codes = self.patch(patch).map(|codes| codes.planes().map(|plane| plane[cell]));
            codes.map(|codes| Bend::of_codes(codes, decoded.code_steps())).unwrap_or_default()
        })
    }

    /// Wind at `position_m` (m/s) in the newest frame, where `y` is an elevation above sea level. Zero before the first wind frame.
    pub fn wind_at(&self, position_m: Vec3) -> Vec3 {
        let at_m = self.above_ground_m(position_m);
        self.wind_field().map_or(Vec3::ZERO, |wind| Vec3::from_array(wind.wind_at(at_m)))
    }

    /// Dust concentration at `position_m` in the newest frame; see [`wind_at`](Self::wind_at).
    pub fn dust_at(&self, position_m: Vec3) -> f32 {
        let at_m = self.above_ground_m(position_m);
        self.wind_field().map_or(0.0, |wind| wind.dust_at(at_m))
    }

    /// X, height above the ground, and Z (m).
    fn above_ground_m(&self, Vec3 { x, y, z }: Vec3) -> [f32; 3] {
        [x, y - self.ground_m(x, z), z]
    }
}
