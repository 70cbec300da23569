//! The camera: position, direction, projection, and its text form in a link.

use glam::{Mat4, Vec3, Vec4};
use std::f32::consts::{FRAC_PI_2, TAU};

/// Distance of the near plane (m).
pub const NEAR_M: f32 = 0.02;

/// Maximum pitch up or down (rad).
pub const PITCH_LIMIT_RAD: f32 = 1.5;

/// A camera without roll.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Position (m).
    pub eye_m: Vec3,
    /// Heading (rad) from north towards east.
    pub heading_rad: f32,
    /// Pitch (rad), negative looks down; within ±[`PITCH_LIMIT_RAD`].
    pub pitch_rad: f32,
    /// Vertical field of view (rad). Default 1.0.
    pub fov_rad: f32,
    /// Position (m) that trees must not hide: those in front of it fade. Default `None`. Not part of a link.
    pub target_m: Option<Vec3>,
}

impl Default for Camera {
    fn default() -> Self {
        Self { eye_m: Vec3::new(0.0, 2.0, 0.0), heading_rad: 0.0, pitch_rad: 0.0, fov_rad: 1.0, target_m: None }
    }
}

impl Camera {
    /// Unit vector of the viewing direction.
    pub fn forward(&self) -> Vec3 {
        let (sin_pitch, cos_pitch) = self.pitch_rad.sin_cos();
        let (sin_heading, cos_heading) = self.heading_rad.sin_cos();
        Vec3::new(sin_heading * cos_pitch, sin_pitch, -cos_heading * cos_pitch)
    }

    /// Horizontal unit vector to the right.
    pub fn right(&self) -> Vec3 {
        let (sin_heading, cos_heading) = self.heading_rad.sin_cos();
        Vec3::new(cos_heading, 0.0, sin_heading)
    }

    /// World to view space, which looks along −Z with Y up.
    pub fn view_from_world(&self) -> Mat4 {
        glam::camera::rh::view::look_to_mat4(self.eye_m, self.forward(), Vec3::Y)
    }

    /// View to clip space with reversed depth: 1 at [`NEAR_M`], 0 infinitely far.
    pub fn projection_from_view(&self, aspect: f32) -> Mat4 {
        let scale = 1.0 / (0.5 * self.fov_rad).tan();
        Mat4::from_cols(
            Vec4::new(scale / aspect, 0.0, 0.0, 0.0),
            Vec4::new(0.0, scale, 0.0, 0.0),
            Vec4::new(0.0, 0.0, 0.0, -1.0),
            Vec4::new(0.0, 0.0, NEAR_M, 0.0),
        )
    }

    /// World to clip space.
    pub fn projection_from_world(&self, aspect: f32) -> Mat4 {
        self.projection_from_view(aspect) * self.view_from_world()
    }

    /// Turns by angles (rad) to the right and up.
    pub fn turn(&mut self, right_rad: f32, up_rad: f32) {
        self.heading_rad = (self.heading_rad + right_rad).rem_euclid(TAU);
        self.pitch_rad = (self.pitch_rad + up_rad).clamp(-PITCH_LIMIT_RAD, PITCH_LIMIT_RAD);
    }

    /// URL fragment of this view: `x,y,z,heading,pitch` in m and degrees, two decimals.
    pub fn to_hash(&self) -> String {
        let [x, y, z] = self.eye_m.to_array();
        format!("{x:.2},{y:.2},{z:.2},{:.2},{:.2}", self.heading_rad.to_degrees(), self.pitch_rad.to_degrees())
    }

    /// Parses a URL fragment, with or without `#`; `None` if it is not a view.
    pub fn from_hash(hash: &str) -> Option<Self> {
        let mut numbers = hash.trim_start_matches('#').split(',').map(|part| part.trim().parse::<f32>().ok());
        let mut next = |limit: f32| numbers.next().flatten().filter(|value| value.abs() <= limit);
        let eye_m = Vec3::new(next(1e6)?, next(1e6)?, next(1e6)?);
        let (heading, pitch) = (next(1e4)?, next(90.0)?);
        let pitch_rad = pitch.to_radians().clamp(-PITCH_LIMIT_RAD, PITCH_LIMIT_RAD);
        numbers.next().is_none().then_some(Self { eye_m, heading_rad: heading.to_radians().rem_euclid(TAU), pitch_rad, ..Self::default() })
    }

    /// Start view of a scene, where `ground_m` is the elevation of the ground at (x, z).
    pub fn start(start: &prairie_core::scene::CameraStart, extent_m: [f32; 2], ground_m: impl Fn(f32, f32) -> f32) -> Self {
        let [x, z] = [start.at[0] * extent_m[0], start.at[1] * extent_m[1]];
        let pitch_rad = start.pitch_rad.clamp(-FRAC_PI_2, FRAC_PI_2);
        let eye_m = Vec3::new(x, ground_m(x, z) + start.height_m, z);
        Self { eye_m, heading_rad: start.heading_rad.rem_euclid(TAU), pitch_rad, ..Self::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_follow_the_compass() {
        let north = Camera::default();
        assert!((north.forward() - Vec3::NEG_Z).length() < 1e-6);
        let east = Camera { heading_rad: FRAC_PI_2, ..north };
        assert!((east.forward() - Vec3::X).length() < 1e-6);
        assert!((north.right() - Vec3::X).length() < 1e-6);
    }

    #[test]
    fn depth_runs_from_one_to_zero() {
        let camera = Camera::default();
        let clip = |distance: f32| camera.projection_from_world(1.6).project_point3(camera.eye_m + camera.forward() * distance);
        assert!((clip(NEAR_M).z - 1.0).abs() < 1e-4);
        assert!(clip(10.0).z > clip(1000.0).z && clip(1e6).z > 0.0);
    }

    #[test]
    fn a_point_up_right_projects_up_right() {
        let camera = Camera { heading_rad: 0.7, ..Camera::default() };
        let point = camera.eye_m + camera.forward() * 10.0 + camera.right() + Vec3::Y;
        let clip = camera.projection_from_world(1.0).project_point3(point);
        assert!(clip.x > 0.0 && clip.y > 0.0);
    }

    #[test]
    fn a_url_fragment_restores_its_view() {
        let camera = Camera { eye_m: Vec3::new(12.25, 3.5, 99.75), heading_rad: 1.0, pitch_rad: -0.2, ..Camera::default() };
        let again = Camera::from_hash(&format!("#{}", camera.to_hash())).expect("a hash");
        assert!((again.eye_m - camera.eye_m).length() < 0.01);
        assert!((again.heading_rad - camera.heading_rad).abs() < 1e-3 && (again.pitch_rad - camera.pitch_rad).abs() < 1e-3);
        for bad in ["", "#", "1,2,3", "1,2,3,4,5,6", "nan,0,0,0,0", "1,2,3,4,inf", "a,b,c,d,e"] {
            assert_eq!(Camera::from_hash(bad), None, "{bad}");
        }
    }
}
