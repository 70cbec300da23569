//! Where the visitor's eye is: free over the land, or behind what one drives.

use crate::camera::{Camera, PITCH_LIMIT_RAD};
use crate::controls::Controls;
use crate::damped::{Damped, wrap_angle};
use glam::{Quat, Vec3};
use shared::scene::VehicleKind;
use shared::wire::ObjectPose;

/// Lowest and highest the eye goes above the land (m): from an ant's to a lark's.
const HEIGHT_RANGE_M: [f32; 2] = [0.05, 800.0];

/// Least height of a chase camera above the land (m).
const CLEARANCE_M: f32 = 0.4;

/// How long the free camera takes to reach its speed and to come to rest (s).
const GLIDE_SECS: f32 = 0.12;

/// How fast the view swings round behind a vehicle that turns (s).
const SWING_SECS: f32 = 0.28;

/// How long the way from one seat to another takes (s, time constant).
const CHANGE_SECS: f32 = 0.3;

/// How long a look around in a vehicle outlasts the drive that follows it (s).
const LOOK_BACK_SECS: f32 = 0.9;

/// Speed above which a vehicle pulls the look back behind it (m/s).
const PULL_SPEED_M_PER_S: f32 = 1.5;

/// Where a chase camera sits when a vehicle is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Seat {
    /// Distance behind the vehicle's centre (m).
    distance_m: f32,
    /// Height above the vehicle's centre (m).
    height_m: f32,
}

fn seat(kind: VehicleKind) -> Seat {
    match kind {
        VehicleKind::Car => Seat { distance_m: 8.0, height_m: 2.8 },
        VehicleKind::Monster => Seat { distance_m: 5.0, height_m: 2.0 },
        VehicleKind::Helicopter => Seat { distance_m: 15.0, height_m: 4.5 },
        VehicleKind::Sled => Seat { distance_m: 10.0, height_m: 4.0 },
        VehicleKind::Ball => Seat { distance_m: 7.0, height_m: 2.4 },
    }
}

/// The eye and what moves it. All motion is critically damped, and the same at any frame rate.
#[derive(Clone, Debug)]
pub struct Rig {
    camera: Camera,
    /// The free camera's speed forward and to the right (m/s), and of its turn to the right (rad/s).
    glide: [Damped; 3],
    height: Damped,
    height_goal_m: f32,
    chase: Option<Chase>,
    /// What is left of the way from the seat before: eye (m), heading and pitch (rad).
    change: [Damped; 5],
}

#[derive(Clone, Debug)]
struct Chase {
    kind: VehicleKind,
    seat: Seat,
    distance: Damped,
    height: Damped,
    floor: Damped,
    heading: Damped,
    /// Looked aside and up by the visitor (rad).
    aside_rad: f32,
    up_rad: f32,
}

impl Rig {
    /// A free camera that starts as `camera`, over land of the height `ground_m` below it.
    pub fn new(camera: Camera, ground_m: f32) -> Self {
        let height_m = (camera.eye_m.y - ground_m).clamp(HEIGHT_RANGE_M[0], HEIGHT_RANGE_M[1]);
        Self {
            camera,
            glide: Default::default(),
            height: Damped::at(height_m),
            height_goal_m: height_m,
            chase: None,
            change: Default::default(),
        }
    }

    /// What the visitor sees.
    pub fn camera(&self) -> Camera {
        self.camera
    }

    /// Turns the view by a drag of the mouse, a thumb or a stick (rad, right and up).
    pub fn look(&mut self, right_rad: f32, up_rad: f32) {
        match &mut self.chase {
            Some(chase) => {
                chase.aside_rad = wrap_angle(chase.aside_rad + right_rad);
                chase.up_rad = (chase.up_rad + up_rad).clamp(-1.0, 0.9);
            }
            None => {
                self.camera.heading_rad = wrap_angle(self.camera.heading_rad + right_rad);
                self.camera.pitch_rad = (self.camera.pitch_rad + up_rad).clamp(-PITCH_LIMIT_RAD, PITCH_LIMIT_RAD);
            }
        }
    }

    /// Goes nearer (negative) or farther by notches of a wheel: the distance behind a vehicle, or the height of a free camera.
    pub fn zoom(&mut self, notches: f32) {
        let factor = 1.15_f32.powf(notches);
        match &mut self.chase {
            Some(chase) => chase.seat.distance_m = (chase.seat.distance_m * factor).clamp(2.5, 120.0),
            None => self.set_height(self.height_goal_m * factor),
        }
    }

    /// Lifts the eye to a height above the land, or above what one drives (m).
    pub fn set_height(&mut self, height_m: f32) {
        match &mut self.chase {
            Some(chase) => {
                chase.seat.height_m = height_m;
                chase.seat.distance_m = seat(chase.kind).distance_m.max(1.6 * height_m);
            }
            None => self.height_goal_m = height_m.clamp(HEIGHT_RANGE_M[0], HEIGHT_RANGE_M[1]),
        }
    }

    /// Moves the eye for `dt_secs`: behind `vehicle` if there is one, else freely by `controls`. `ground_m` gives the height of
    /// the land at (x, z).
    pub fn advance(&mut self, controls: Controls, vehicle: Option<&ObjectPose>, ground_m: impl Fn(f32, f32) -> f32, dt_secs: f32) {
        let Some(pose) = vehicle else {
            if self.chase.is_some() {
                *self = Self::new(self.camera, ground_m(self.camera.eye_m.x, self.camera.eye_m.z));
            }
            return self.advance_freely(controls, ground_m, dt_secs);
        };
        let before = self.camera;
        let taken = self.chase.as_ref().is_none_or(|chase| chase.kind != pose.kind);
        let goal = self.behind(pose, &ground_m, dt_secs);
        if taken {
            let [x, y, z] = (before.eye_m - goal.eye_m).to_array();
            let [right, up] = [before.heading_rad - goal.heading_rad, before.pitch_rad - goal.pitch_rad].map(wrap_angle);
            self.change = [x, y, z, right, up].map(Damped::at);
        }
        let [x, y, z, right, up] = self.change.each_mut().map(|left| left.follow(0.0, CHANGE_SECS, dt_secs));
        let mut eye_m = goal.eye_m + Vec3::new(x, y, z);
        eye_m.y = eye_m.y.max(ground_m(eye_m.x, eye_m.z) + CLEARANCE_M);
        self.camera = Camera {
            eye_m,
            heading_rad: wrap_angle(goal.heading_rad + right),
            pitch_rad: (goal.pitch_rad + up).clamp(-PITCH_LIMIT_RAD, PITCH_LIMIT_RAD),
            ..self.camera
        };
    }

    fn advance_freely(&mut self, controls: Controls, ground_m: impl Fn(f32, f32) -> f32, dt_secs: f32) {
        let speed_m_per_s = (4.0 + 1.2 * self.height.value).min(80.0);
        let turn_rad_per_s = 1.4;
        let goals = [controls.forward * speed_m_per_s, controls.side * speed_m_per_s, controls.turn * turn_rad_per_s];
        let [forward, right, turn] = std::array::from_fn(|i| self.glide[i].follow(goals[i], GLIDE_SECS, dt_secs) * dt_secs);
        self.look(turn, 0.0);
        self.set_height(self.height_goal_m * (controls.rise * 1.2 * dt_secs).exp());
        self.height.follow(self.height_goal_m, 0.18, dt_secs);

        let (sin, cos) = self.camera.heading_rad.sin_cos();
        let eye_m = &mut self.camera.eye_m;
        *eye_m += Vec3::new(sin, 0.0, -cos) * forward + Vec3::new(cos, 0.0, sin) * right;
        eye_m.y = ground_m(eye_m.x, eye_m.z) + self.height.value;
    }

    fn behind(&mut self, pose: &ObjectPose, ground_m: &impl Fn(f32, f32) -> f32, dt_secs: f32) -> Camera {
        let place = Vec3::from(pose.position_m);
        let facing_rad = heading_of(pose);
        let chase = match &mut self.chase {
            Some(chase) if chase.kind == pose.kind => chase,
            other => {
                let seat = seat(pose.kind);
                other.insert(Chase {
                    kind: pose.kind,
                    seat,
                    distance: Damped::at(seat.distance_m),
                    height: Damped::at(seat.height_m),
                    floor: Damped::at(place.y),
                    heading: Damped::at(facing_rad),
                    aside_rad: 0.0,
                    up_rad: 0.0,
                })
            }
        };
        if Vec3::from(pose.velocity_m_per_s).length() > PULL_SPEED_M_PER_S {
            let keep = (-dt_secs / LOOK_BACK_SECS).exp();
            chase.aside_rad *= keep;
            chase.up_rad *= keep;
        }
        let heading_rad = chase.heading.follow_angle(facing_rad, SWING_SECS, dt_secs) + chase.aside_rad;
        let distance_m = chase.distance.follow(chase.seat.distance_m, 0.2, dt_secs);
        let height_m = chase.height.follow(chase.seat.height_m, 0.2, dt_secs);
        let center = Vec3::new(place.x, chase.floor.follow(place.y, 0.1, dt_secs), place.z);

        let rise_rad = (height_m / distance_m).atan() - chase.up_rad;
        let arm_m = distance_m.hypot(height_m);
        let (sin, cos) = heading_rad.sin_cos();
        let (up, back) = rise_rad.clamp(-0.3, 1.5).sin_cos();
        let mut eye_m = center + Vec3::new(-sin * back, up, cos * back) * arm_m;
        eye_m.y = eye_m.y.max(ground_m(eye_m.x, eye_m.z) + CLEARANCE_M);

        let sight = center + Vec3::Y * (0.1 * arm_m) - eye_m;
        Camera { eye_m, heading_rad, pitch_rad: sight.y.atan2(sight.x.hypot(sight.z)), ..self.camera }
    }
}

/// Heading of a vehicle (rad) from north towards east.
fn heading_of(pose: &ObjectPose) -> f32 {
    if pose.kind == VehicleKind::Ball {
        return pose.part_rad;
    }
    let forward = Quat::from_array(pose.rotation) * Vec3::NEG_Z;
    forward.x.atan2(-forward.z)
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
            rig.advance(Controls::default(), vehicle, flat, 0.02);
        }
    }

    #[test]
    fn the_eye_settles_behind_the_car_and_looks_where_it_heads() {
        let mut rig = Rig::new(Camera { eye_m: Vec3::new(50.0, 2.0, 50.0), ..Camera::default() }, 0.0);
        let east = car(10.0, 20.0, std::f32::consts::FRAC_PI_2);
        settle(&mut rig, Some(&east));
        let camera = rig.camera();
        assert!((camera.eye_m - Vec3::new(2.0, 3.5, 20.0)).length() < 0.01, "{:?}", camera.eye_m);
        let to_car = (Vec3::from(east.position_m) - camera.eye_m).normalize();
        assert!(camera.forward().dot(to_car) > 0.99);
    }

    #[test]
    fn taking_and_leaving_a_car_makes_no_jump() {
        let mut rig = Rig::new(Camera { eye_m: Vec3::new(30.0, 2.0, 20.0), heading_rad: 1.0, pitch_rad: -0.1, ..Camera::default() }, 0.0);
        let parked = car(10.0, 20.0, 0.4);
        let mut before = rig.camera();
        for step in 0..400 {
            rig.advance(Controls::default(), (step < 200).then_some(&parked), flat, 0.01);
            let moved = rig.camera().eye_m.distance(before.eye_m);
            let turned = wrap_angle(rig.camera().heading_rad - before.heading_rad).abs();
            assert!(moved < 0.4 && turned < 0.1, "step {step}: {moved} m, {turned} rad");
            before = rig.camera();
        }
    }

    #[test]
    fn the_presets_are_heights_above_the_land() {
        let mut rig = Rig::new(Camera { eye_m: Vec3::new(5.0, 13.0, 5.0), ..Camera::default() }, 11.0);
        for height_m in [1.0, 5.0, 10.0, 20.0] {
            rig.set_height(height_m);
            for _ in 0..300 {
                rig.advance(Controls::default(), None, |_, _| 11.0, 0.02);
            }
            assert!((rig.camera().eye_m.y - 11.0 - height_m).abs() < 0.01);
        }
    }

    #[test]
    fn the_free_camera_walks_where_it_looks_and_stays_above_the_land() {
        let mut rig = Rig::new(Camera { eye_m: Vec3::new(0.0, 2.0, 0.0), ..Camera::default() }, 0.0);
        let hill = |_: f32, z: f32| -0.5 * z;
        for _ in 0..100 {
            rig.advance(Controls { forward: 1.0, ..Default::default() }, None, hill, 0.02);
        }
        let eye = rig.camera().eye_m;
        assert!(eye.z < -5.0 && eye.x.abs() < 1e-3, "{eye}");
        assert!((eye.y - hill(eye.x, eye.z) - 2.0).abs() < 0.01);
    }

    #[test]
    fn a_view_that_is_set_stays_exactly() {
        let camera = Camera { eye_m: Vec3::new(3.0, 7.5, 4.0), heading_rad: 0.3, pitch_rad: -0.6, ..Camera::default() };
        let mut rig = Rig::new(camera, 0.0);
        settle(&mut rig, None);
        assert!((rig.camera().eye_m - camera.eye_m).length() < 1e-4 && rig.camera().heading_rad == camera.heading_rad);
    }
}
