//! Camera rig: moves the camera freely above the ground, or behind the driven vehicle.

use crate::camera::{Camera, PITCH_LIMIT_RAD};
use crate::controls::Controls;
use crate::damped::{Damped, wrap_angle};
use crate::sight::{Sight, above_land};
use crate::vehicle::{ChaseOffset, HeadingSource, profile};
use glam::{Quat, Vec3};
use prairie_core::scene::VehicleKind;
use prairie_core::wire::ObjectPose;

/// Range of the free camera's height above the ground (m).
const HEIGHT_RANGE_M: [f32; 2] = [0.05, 800.0];

/// Minimum height of a chase camera above the ground (m).
const CLEARANCE_M: f32 = 0.4;

/// Time constant with which the free camera reaches its speed (s).
const GLIDE_SECS: f32 = 0.12;

/// Time constant with which the chase camera follows a vehicle's turn (s).
const FOLLOW_TURN_SECS: f32 = 0.28;

/// Time constant of the transition to a newly taken vehicle (s).
const TRANSITION_SECS: f32 = 0.3;

/// Shortest arm of a chase camera in front of a crown, relative to its whole arm.
const SHORTEST_ARM: f32 = 0.35;

/// Time constant with which the arm grows again behind a crown (s). It shortens at once.
const ARM_GROWS_SECS: f32 = 0.4;

/// Time constant with which a view turned aside returns to straight ahead while driving (s).
const RECENTRE_SECS: f32 = 0.9;

/// Speed of the vehicle above which the view recentres (m/s).
const RECENTRE_SPEED_M_PER_S: f32 = 1.5;

/// A camera and its motion, which is critically damped and independent of the frame rate.
#[derive(Clone, Debug)]
pub struct Rig {
    camera: Camera,
    /// Speed of the free camera forward and to the right (m/s), and its turn rate to the right (rad/s).
    speed: [Damped; 3],
    height: Damped,
    height_goal_m: f32,
    chase: Option<Chase>,
    /// Remaining offset of a transition: eye (m), heading and pitch (rad).
    transition: [Damped; 5],
}

#[derive(Clone, Debug)]
struct Chase {
    kind: VehicleKind,
    offset: ChaseOffset,
    distance: Damped,
    height: Damped,
    floor: Damped,
    heading: Damped,
    /// Length of the arm relative to the whole, shorter in front of crowns.
    arm: Damped,
    /// View turned by the user, to the right and up (rad).
    right_rad: f32,
    up_rad: f32,
}

impl Rig {
    /// A free camera that starts at `camera`, where the ground has the elevation `ground_m`.
    pub fn new(camera: Camera, ground_m: f32) -> Self {
        let height_m = (camera.eye_m.y - ground_m).clamp(HEIGHT_RANGE_M[0], HEIGHT_RANGE_M[1]);
        Self {
            camera,
            speed: Default::default(),
            height: Damped::at(height_m),
            height_goal_m: height_m,
            chase: None,
            transition: Default::default(),
        }
    }

    /// The current camera.
    pub fn camera(&self) -> Camera {
        self.camera
    }

    /// Turns the view to the right and up (rad).
    pub fn look(&mut self, right_rad: f32, up_rad: f32) {
        match &mut self.chase {
            Some(chase) => {
                chase.right_rad = wrap_angle(chase.right_rad + right_rad);
                chase.up_rad = (chase.up_rad + up_rad).clamp(-1.0, 0.9);
            }
            None => {
                self.camera.heading_rad = wrap_angle(self.camera.heading_rad + right_rad);
                self.camera.pitch_rad = (self.camera.pitch_rad + up_rad).clamp(-PITCH_LIMIT_RAD, PITCH_LIMIT_RAD);
            }
        }
    }

    /// Zooms by notches of a wheel, negative for nearer: changes the distance behind a vehicle, or the height of the free camera.
    pub fn zoom(&mut self, notches: f32) {
        let factor = 1.15_f32.powf(notches);
        match &mut self.chase {
            Some(chase) => chase.offset.distance_m = (chase.offset.distance_m * factor).clamp(2.5, 120.0),
            None => self.set_height(self.height_goal_m * factor),
        }
    }

    /// Sets the camera's height above the ground, or above the vehicle (m).
    pub fn set_height(&mut self, height_m: f32) {
        match &mut self.chase {
            Some(chase) => {
                chase.offset.height_m = height_m;
                chase.offset.distance_m = profile(chase.kind).chase.distance_m.max(1.6 * height_m);
            }
            None => self.height_goal_m = height_m.clamp(HEIGHT_RANGE_M[0], HEIGHT_RANGE_M[1]),
        }
    }

    /// Advances the camera by `dt_secs`: behind `vehicle` if there is one, else freely by `controls`. `ground_m` is the elevation of the ground at
    /// (x, z). The chase camera keeps above the land, and outside the crowns of `sight` unless the vehicle is in one.
    pub fn advance(
        &mut self,
        controls: Controls,
        vehicle: Option<&ObjectPose>,
        sight: &Sight,
        ground_m: impl Fn(f32, f32) -> f32,
        dt_secs: f32,
    ) {
        let Some(pose) = vehicle else {
            if self.chase.is_some() {
                let camera = Camera { target_m: None, ..self.camera };
                *self = Self::new(camera, ground_m(camera.eye_m.x, camera.eye_m.z));
            }
            return self.advance_freely(controls, ground_m, dt_secs);
        };
        let before = self.camera;
        let taken = self.chase.as_ref().is_none_or(|chase| chase.kind != pose.kind);
        let goal = self.chase_camera(pose, sight, &ground_m, dt_secs);
        if taken {
            let [x, y, z] = (before.eye_m - goal.eye_m).to_array();
            let [right, up] = [before.heading_rad - goal.heading_rad, before.pitch_rad - goal.pitch_rad].map(wrap_angle);
            self.transition = [x, y, z, right, up].map(Damped::at);
        }
        let [x, y, z, right, up] = self.transition.each_mut().map(|left| left.follow(0.0, TRANSITION_SECS, dt_secs));
        let mut eye_m = goal.eye_m + Vec3::new(x, y, z);
        eye_m.y = eye_m.y.max(ground_m(eye_m.x, eye_m.z) + CLEARANCE_M);
        self.camera = Camera {
            eye_m,
            heading_rad: wrap_angle(goal.heading_rad + right),
            pitch_rad: (goal.pitch_rad + up).clamp(-PITCH_LIMIT_RAD, PITCH_LIMIT_RAD),
            ..goal
        };
    }

    fn advance_freely(&mut self, controls: Controls, ground_m: impl Fn(f32, f32) -> f32, dt_secs: f32) {
        let speed_m_per_s = (4.0 + 1.2 * self.height.value).min(80.0);
        let turn_rad_per_s = 1.4;
        let goals = [controls.forward * speed_m_per_s, controls.side * speed_m_per_s, controls.turn * turn_rad_per_s];
        let [forward, right, turn] = std::array::from_fn(|i| self.speed[i].follow(goals[i], GLIDE_SECS, dt_secs) * dt_secs);
        self.look(turn, 0.0);
        self.set_height(self.height_goal_m * (controls.rise * 1.2 * dt_secs).exp());
        self.height.follow(self.height_goal_m, 0.18, dt_secs);

        let (sin, cos) = self.camera.heading_rad.sin_cos();
        let eye_m = &mut self.camera.eye_m;
        *eye_m += Vec3::new(sin, 0.0, -cos) * forward + Vec3::new(cos, 0.0, sin) * right;
        eye_m.y = ground_m(eye_m.x, eye_m.z) + self.height.value;
    }

    fn chase_camera(&mut self, pose: &ObjectPose, sight: &Sight, ground_m: &impl Fn(f32, f32) -> f32, dt_secs: f32) -> Camera {
        let position = Vec3::from(pose.position_m);
        let facing_rad = heading_of(pose);
        let chase = match &mut self.chase {
            Some(chase) if chase.kind == pose.kind => chase,
            other => other.insert(Chase::new(pose.kind, position.y, facing_rad)),
        };
        if Vec3::from(pose.velocity_m_per_s).length() > RECENTRE_SPEED_M_PER_S {
            let keep = (-dt_secs / RECENTRE_SECS).exp();
            chase.right_rad *= keep;
            chase.up_rad *= keep;
        }
        let heading_rad = chase.heading.follow_angle(facing_rad, FOLLOW_TURN_SECS, dt_secs) + chase.right_rad;
        let distance_m = chase.distance.follow(chase.offset.distance_m, 0.2, dt_secs);
        let height_m = chase.height.follow(chase.offset.height_m, 0.2, dt_secs);
        let center = Vec3::new(position.x, chase.floor.follow(position.y, 0.1, dt_secs), position.z);

        let rise_rad = (height_m / distance_m).atan() - chase.up_rad;
        let arm_m = distance_m.hypot(height_m);
        let (sin, cos) = heading_rad.sin_cos();
        let (up, back) = rise_rad.clamp(-0.3, 1.5).sin_cos();
        let target_m = center + Vec3::Y * (0.1 * arm_m);
        let whole_m = above_land(target_m, center + Vec3::new(-sin * back, up, cos * back) * arm_m, CLEARANCE_M, ground_m);
        let eye_m = target_m.lerp(whole_m, chase.shortened(sight.clear_fraction(target_m, whole_m), dt_secs));

        let look = target_m - eye_m;
        Camera { eye_m, heading_rad, pitch_rad: look.y.atan2(look.x.hypot(look.z)), target_m: Some(target_m), ..self.camera }
    }
}

impl Chase {
    fn new(kind: VehicleKind, floor_m: f32, heading_rad: f32) -> Self {
        let offset = profile(kind).chase;
        Self {
            kind,
            offset,
            distance: Damped::at(offset.distance_m),
            height: Damped::at(offset.height_m),
            floor: Damped::at(floor_m),
            heading: Damped::at(heading_rad),
            arm: Damped::at(1.0),
            right_rad: 0.0,
            up_rad: 0.0,
        }
    }

    /// Length of the arm relative to the whole, where a fraction `clear` of it is free of crowns.
    fn shortened(&mut self, clear: f32, dt_secs: f32) -> f32 {
        let most = clear.max(SHORTEST_ARM);
        if self.arm.follow(most, ARM_GROWS_SECS, dt_secs) > most {
            self.arm = Damped::at(most);
        }
        self.arm.value
    }
}

/// Heading of a vehicle (rad) from north towards east.
fn heading_of(pose: &ObjectPose) -> f32 {
    match profile(pose.kind).heading {
        HeadingSource::PartAngle => pose.part_rad,
        HeadingSource::Rotation => {
            let forward = Quat::from_array(pose.rotation) * Vec3::NEG_Z;
            forward.x.atan2(-forward.z)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn car(x_m: f32, z_m: f32, heading_rad: f32) -> ObjectPose {
        ObjectPose {
            id: 1,
            kind: VehicleKind::Car,
            position_m: [x_m, 0.7, z_m],
            rotation: Quat::from_rotation_y(-heading_rad).to_array(),
            velocity_m_per_s: [0.0; 3],
            part_rad: 0.0,
        }
    }

    fn flat(_: f32, _: f32) -> f32 {
        0.0
    }

    fn settle(rig: &mut Rig, vehicle: Option<&ObjectPose>) {
        for _ in 0..300 {
            rig.advance(Controls::default(), vehicle, &Sight::default(), flat, 0.02);
        }
    }

    #[test]
    fn the_chase_camera_settles_behind_the_car_and_looks_at_it() {
        let mut rig = Rig::new(Camera { eye_m: Vec3::new(50.0, 2.0, 50.0), ..Camera::default() }, 0.0);
        let east = car(10.0, 20.0, std::f32::consts::FRAC_PI_2);
        settle(&mut rig, Some(&east));
        let camera = rig.camera();
        assert!((camera.eye_m - Vec3::new(2.0, 3.5, 20.0)).length() < 0.01, "{:?}", camera.eye_m);
        let to_car = (Vec3::from(east.position_m) - camera.eye_m).normalize();
        assert!(camera.forward().dot(to_car) > 0.99);
    }

    #[test]
    fn taking_and_leaving_a_car_moves_the_camera_smoothly() {
        let mut rig = Rig::new(Camera { eye_m: Vec3::new(30.0, 2.0, 20.0), heading_rad: 1.0, pitch_rad: -0.1, ..Camera::default() }, 0.0);
        let parked = car(10.0, 20.0, 0.4);
        let mut before = rig.camera();
        for step in 0..400 {
            rig.advance(Controls::default(), (step < 200).then_some(&parked), &Sight::default(), flat, 0.01);
            let moved = rig.camera().eye_m.distance(before.eye_m);
            let turned = wrap_angle(rig.camera().heading_rad - before.heading_rad).abs();
            assert!(moved < 0.4 && turned < 0.1, "step {step}: {moved} m, {turned} rad");
            before = rig.camera();
        }
    }

    #[test]
    fn height_presets_are_above_the_ground() {
        let mut rig = Rig::new(Camera { eye_m: Vec3::new(5.0, 13.0, 5.0), ..Camera::default() }, 11.0);
        for height_m in [1.0, 5.0, 10.0, 20.0] {
            rig.set_height(height_m);
            for _ in 0..300 {
                rig.advance(Controls::default(), None, &Sight::default(), |_, _| 11.0, 0.02);
            }
            assert!((rig.camera().eye_m.y - 11.0 - height_m).abs() < 0.01);
        }
    }

    #[test]
    fn the_free_camera_moves_where_it_looks_and_follows_the_ground() {
        let mut rig = Rig::new(Camera { eye_m: Vec3::new(0.0, 2.0, 0.0), ..Camera::default() }, 0.0);
        let hill = |_: f32, z: f32| -0.5 * z;
        for _ in 0..100 {
            rig.advance(Controls { forward: 1.0, ..Default::default() }, None, &Sight::default(), hill, 0.02);
        }
        let eye = rig.camera().eye_m;
        assert!(eye.z < -5.0 && eye.x.abs() < 1e-3, "{eye}");
        assert!((eye.y - hill(eye.x, eye.z) - 2.0).abs() < 0.01);
    }

    #[test]
    fn a_new_camera_does_not_drift() {
        let camera = Camera { eye_m: Vec3::new(3.0, 7.5, 4.0), heading_rad: 0.3, pitch_rad: -0.6, ..Camera::default() };
        let mut rig = Rig::new(camera, 0.0);
        settle(&mut rig, None);
        assert!((rig.camera().eye_m - camera.eye_m).length() < 1e-4 && rig.camera().heading_rad == camera.heading_rad);
    }
}
