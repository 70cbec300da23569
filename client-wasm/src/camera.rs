//! The camera: where it is, how it moves freely or behind an object, and how an address names it.

use glam::{Mat4, Quat, Vec3, Vec4};
use shared::wire::ObjectPose;
use std::f32::consts::{FRAC_PI_2, TAU};

/// Nearest distance that is drawn (m).
pub const NEAR_M: f32 = 0.08;

/// Largest pitch up or down (rad).
pub const PITCH_LIMIT_RAD: f32 = 1.5;

/// Heights above the ground of the presets (m), keys 1 to 4.
pub const PRESET_HEIGHTS_M: [f32; 4] = [1.0, 5.0, 10.0, 20.0];

/// Pitch of each preset (rad).
const PRESET_PITCHES_RAD: [f32; 4] = [-0.06, -0.18, -0.30, -0.45];

/// Rate at which the chasing camera takes up its place (1/s).
const CHASE_RATE_PER_S: f32 = 5.0;

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
}

impl Default for Camera {
    fn default() -> Self {
        Self { eye_m: Vec3::new(0.0, 2.0, 0.0), heading_rad: 0.0, pitch_rad: 0.0, fov_rad: 1.0 }
    }
}

/// A wish to move: shares −1..=1 along the camera's own axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Forward (+) or backward (−), along the ground.
    pub forward: f32,
    /// Right (+) or left (−).
    pub right: f32,
    /// Up (+) or down (−).
    pub up: f32,
}

impl Camera {
    /// Unit vector of the view.
    pub fn forward(&self) -> Vec3 {
        let (sin_pitch, cos_pitch) = self.pitch_rad.sin_cos();
        let (sin_heading, cos_heading) = self.heading_rad.sin_cos();
        Vec3::new(sin_heading * cos_pitch, sin_pitch, -cos_heading * cos_pitch)
    }

    /// Unit vector to the right, level.
    pub fn right(&self) -> Vec3 {
        let (sin_heading, cos_heading) = self.heading_rad.sin_cos();
        Vec3::new(cos_heading, 0.0, sin_heading)
    }

    /// World to view: the view looks along −Z, Y up.
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

    /// Moves freely for `dt_secs` at a speed that grows with the height above the ground, and keeps above the ground.
    /// `ground_m` gives the height of the land at `(x_m, z_m)`.
    pub fn fly(&mut self, motion: Motion, dt_secs: f32, ground_m: impl Fn(f32, f32) -> f32) {
        let clearance_m = (self.eye_m.y - ground_m(self.eye_m.x, self.eye_m.z)).max(0.0);
        let speed_m_per_s = 5.0 + 1.2 * clearance_m.min(200.0);
        let level = Vec3::new(self.heading_rad.sin(), 0.0, -self.heading_rad.cos());
        let wish = level * motion.forward + self.right() * motion.right + Vec3::Y * motion.up;
        self.eye_m += wish.clamp_length_max(1.0) * speed_m_per_s * dt_secs;
        let ground = ground_m(self.eye_m.x, self.eye_m.z);
        if motion.up == 0.0 && clearance_m < 30.0 {
            self.eye_m.y = ground + clearance_m;
        }
        self.eye_m.y = self.eye_m.y.max(ground + 0.15);
    }

    /// Follows an object as a third person (000 chapter 6): behind and above it, looking over it. `orbit_rad` turns the
    /// place about the object; `distance` scales it, 1 for the usual distance.
    pub fn chase(&mut self, pose: &ObjectPose, orbit_rad: f32, distance: f32, dt_secs: f32, ground_m: impl Fn(f32, f32) -> f32) {
        let [half_x, half_y, half_z] = pose.kind.half_extents_m();
        let size_m = half_x.max(half_y).max(half_z);
        let position = Vec3::from(pose.position_m);
        let ahead = Quat::from_array(pose.rotation) * Vec3::NEG_Z;
        let heading = ahead.x.atan2(-ahead.z) + orbit_rad;
        let level = Vec3::new(heading.sin(), 0.0, -heading.cos());
        let wanted = position - level * (size_m * 2.9 * distance) + Vec3::Y * (half_y + size_m * 0.75 * distance);
        let share = 1.0 - (-CHASE_RATE_PER_S * dt_secs).exp();
        self.eye_m += (wanted - self.eye_m) * if self.eye_m.distance(wanted) > 60.0 { 1.0 } else { share };
        self.eye_m.y = self.eye_m.y.max(ground_m(self.eye_m.x, self.eye_m.z) + 0.6);
        self.look_at(position + Vec3::Y * (half_y * 0.8) + level * size_m);
    }

    /// Turns towards a point.
    pub fn look_at(&mut self, point_m: Vec3) {
        let to = point_m - self.eye_m;
        if to.length_squared() > 1e-6 {
            self.heading_rad = to.x.atan2(-to.z).rem_euclid(TAU);
            let level = (to.x * to.x + to.z * to.z).sqrt();
            self.pitch_rad = to.y.atan2(level).clamp(-PITCH_LIMIT_RAD, PITCH_LIMIT_RAD);
        }
    }

    /// Takes up preset `index` (0..4) over the place where the camera is.
    pub fn preset(&mut self, index: usize, ground_m: impl Fn(f32, f32) -> f32) {
        let index = index.min(PRESET_HEIGHTS_M.len() - 1);
        self.eye_m.y = ground_m(self.eye_m.x, self.eye_m.z) + PRESET_HEIGHTS_M[index];
        self.pitch_rad = PRESET_PITCHES_RAD[index];
    }

    /// Fragment of an address that names this view: `x,y,z,heading,pitch` in m and degrees, two decimals.
    pub fn to_hash(&self) -> String {
        let [x, y, z] = self.eye_m.to_array();
        format!("{x:.2},{y:.2},{z:.2},{:.2},{:.2}", self.heading_rad.to_degrees(), self.pitch_rad.to_degrees())
    }

    /// The view that a fragment of an address names, with or without `#`; none when it names none.
    pub fn from_hash(hash: &str) -> Option<Self> {
        let mut numbers = hash.trim_start_matches('#').split(',').map(|part| part.trim().parse::<f32>().ok());
        let mut next = |limit: f32| numbers.next().flatten().filter(|value| value.abs() <= limit);
        let eye_m = Vec3::new(next(1e6)?, next(1e6)?, next(1e6)?);
        let (heading, pitch) = (next(1e4)?, next(90.0)?);
        let pitch_rad = pitch.to_radians().clamp(-PITCH_LIMIT_RAD, PITCH_LIMIT_RAD);
        numbers.next().is_none().then_some(Self { eye_m, heading_rad: heading.to_radians().rem_euclid(TAU), pitch_rad, ..Self::default() })
    }

    /// The view at which a scene starts, over land of height `ground_m`.
    pub fn start(start: &shared::scene::CameraStart, extent_m: [f32; 2], ground_m: impl Fn(f32, f32) -> f32) -> Self {
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
    fn a_point_to_the_right_and_above_lands_there() {
        let camera = Camera { heading_rad: 0.7, ..Camera::default() };
        let point = camera.eye_m + camera.forward() * 10.0 + camera.right() + Vec3::Y;
        let clip = camera.projection_from_world(1.0).project_point3(point);
        assert!(clip.x > 0.0 && clip.y > 0.0);
    }

    #[test]
    fn a_hash_names_its_view_again() {
        let camera = Camera { eye_m: Vec3::new(12.25, 3.5, 99.75), heading_rad: 1.0, pitch_rad: -0.2, ..Camera::default() };
        let again = Camera::from_hash(&format!("#{}", camera.to_hash())).expect("a hash");
        assert!((again.eye_m - camera.eye_m).length() < 0.01);
        assert!((again.heading_rad - camera.heading_rad).abs() < 1e-3 && (again.pitch_rad - camera.pitch_rad).abs() < 1e-3);
        for bad in ["", "#", "1,2,3", "1,2,3,4,5,6", "nan,0,0,0,0", "1,2,3,4,inf", "a,b,c,d,e"] {
            assert_eq!(Camera::from_hash(bad), None, "{bad}");
        }
    }

    #[test]
    fn flying_stays_above_the_ground() {
        let mut camera = Camera::default();
        for _ in 0..200 {
            camera.fly(Motion { forward: 1.0, right: 0.0, up: -1.0 }, 0.05, |x, z| 3.0 + 0.1 * x - 0.2 * z);
        }
        let ground = 3.0 + 0.1 * camera.eye_m.x - 0.2 * camera.eye_m.z;
        assert!(camera.eye_m.y >= ground + 0.14);
    }

    #[test]
    fn the_chasing_camera_comes_to_rest_behind() {
        let pose = ObjectPose {
            id: 1,
            kind: shared::scene::VehicleKind::Car,
            position_m: [50.0, 1.0, 50.0],
            rotation: Quat::IDENTITY.into(),
            velocity_m_per_s: [0.0; 3],
            part_rad: 0.0,
        };
        let mut camera = Camera { eye_m: Vec3::new(40.0, 2.0, 50.0), ..Camera::default() };
        for _ in 0..300 {
            camera.chase(&pose, 0.0, 1.0, 1.0 / 60.0, |_, _| 0.0);
        }
        assert!((camera.eye_m.x - 50.0).abs() < 0.01 && camera.eye_m.z > 53.0, "{camera:?}");
        assert!(camera.pitch_rad < 0.0);
    }
}
