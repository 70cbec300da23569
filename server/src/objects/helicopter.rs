//! A helicopter: thrust along its own up axis, tilted to where it shall go.

use super::ground::Ground;
use rapier3d::prelude::*;
use shared::scene::VehicleKind;
use shared::wire::Drive;
use std::f32::consts::TAU;

const MASS_KG: f32 = 1100.0;
const GRAVITY_M_PER_S2: f32 = 9.81;
const FORWARD_M_PER_S: f32 = 28.0;
const CLIMB_M_PER_S: f32 = 7.0;
const TURN_RAD_PER_S: f32 = 1.2;
/// Time in which the velocity asked for is approached (s).
const RESPONSE_SECS: f32 = 0.8;
/// Largest horizontal and vertical acceleration (m/s²); the first bounds the tilt to 30°.
const TILT_M_PER_S2: f32 = 5.6;
const LIFT_M_PER_S2: f32 = 6.0;
/// Rate at which the body turns to its wanted attitude (1/s), and at which it takes a turning speed on (1/s).
const ATTITUDE_PER_S: f32 = 4.0;
const TURNING_PER_S: f32 = 10.0;
/// Below this clearance the machine stands, unless it is lifted (m).
const LANDED_M: f32 = 0.25;
/// Height above the land that it cannot climb beyond (m).
const CEILING_M: f32 = 250.0;
const ROTOR_RAD_PER_S: f32 = 36.0;

/// What drives one helicopter.
pub(super) struct Helicopter {
    body: RigidBodyHandle,
    rotor_rad: f32,
}

/// Body of a helicopter.
pub(super) fn body() -> (RigidBodyBuilder, ColliderBuilder) {
    let [x, y, z] = VehicleKind::Helicopter.half_extents_m();
    let collider = ColliderBuilder::cuboid(x, y, z).mass(MASS_KG).friction(0.9);
    (RigidBodyBuilder::dynamic().can_sleep(false), collider)
}

impl Helicopter {
    pub(super) fn new(body: RigidBodyHandle) -> Self {
        Self { body, rotor_rad: 0.0 }
    }

    /// Phase of the rotor (rad).
    pub(super) fn rotor_rad(&self) -> f32 {
        self.rotor_rad
    }

    /// Turns the driver's hands into thrust and turning.
    pub(super) fn control(&mut self, drive: Drive, dt_secs: f32, physics: &mut PhysicsWorld, ground: &Ground) {
        self.rotor_rad = (self.rotor_rad + ROTOR_RAD_PER_S * dt_secs) % TAU;
        let body = &mut physics.bodies[self.body];
        let (at, velocity, rotation) = (body.translation(), body.linvel(), *body.rotation());
        let clearance = at.y - VehicleKind::Helicopter.half_extents_m()[1] - ground.height_m([at.x, at.z]);
        body.reset_forces(false);
        if clearance < LANDED_M && drive.lift <= 0.0 {
            return;
        }
        let forward = rotation * -Vector::Z;
        let flat = Vector::new(forward.x, 0.0, forward.z).normalize_or(-Vector::Z);
        let lift = if clearance > CEILING_M { drive.lift.min(0.0) } else { drive.lift };
        let wanted = flat * (drive.throttle * FORWARD_M_PER_S * (1.0 - drive.brake)) + Vector::Y * (lift * CLIMB_M_PER_S);
        let change = (wanted - velocity) / RESPONSE_SECS;
        let level = Vector::new(change.x, 0.0, change.z).clamp_length_max(TILT_M_PER_S2);
        let thrust = level + Vector::Y * (GRAVITY_M_PER_S2 + change.y.clamp(-LIFT_M_PER_S2, LIFT_M_PER_S2));

        let up = rotation * Vector::Y;
        let collective = thrust.dot(up).max(0.0);
        body.add_force(up * (collective * MASS_KG), true);
        let turning = up.cross(thrust.normalize_or(Vector::Y)) * ATTITUDE_PER_S - Vector::Y * (drive.steer * TURN_RAD_PER_S);
        let turned = body.angvel() + (turning - body.angvel()) * (TURNING_PER_S * dt_secs).min(1.0);
        body.set_angvel(turned, true);
    }
}
