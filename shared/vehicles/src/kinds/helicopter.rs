//! Helicopter: thrust along its own up axis, tilted towards the target velocity.

use crate::dynamics::{Airflow, ControlStep, Controller, VehicleDynamics, encoded};
use prairie_core::body::Prism;
use prairie_core::scene::{Objects, VehicleKind};
use prairie_core::wire::Drive;
use rapier3d::prelude::*;
use serde::{Deserialize, Serialize};
use std::f32::consts::TAU;

const MASS_KG: f32 = 1100.0;
const GRAVITY_M_PER_S2: f32 = prairie_core::GRAVITY_M_PER_S2 as f32;
const FORWARD_M_PER_S: f32 = 28.0;
const CLIMB_M_PER_S: f32 = 7.0;
const TURN_RAD_PER_S: f32 = 1.2;
/// Time constant of the approach to the target velocity (s).
const RESPONSE_SECS: f32 = 0.8;
/// Largest horizontal and vertical acceleration (m/s²); the first bounds the tilt to 30°.
const TILT_M_PER_S2: f32 = 5.6;
const LIFT_M_PER_S2: f32 = 6.0;
/// Rates of the approach to the target attitude and the target angular velocity (1/s).
const ATTITUDE_PER_S: f32 = 4.0;
const TURNING_PER_S: f32 = 10.0;
/// Clearance below which the helicopter stays on the ground unless the driver lifts it (m).
const LANDED_M: f32 = 0.25;
/// Greatest height above the terrain (m).
const CEILING_M: f32 = 250.0;
const ROTOR_RAD_PER_S: f32 = 36.0;

pub(super) const DYNAMICS: VehicleDynamics = VehicleDynamics {
    body,
    controller: |body, objects, _| Box::new(Helicopter { body, half_height_m: half_extents_m(objects)[1], rotor_rad: 0.0 }),
    prisms,
    airflow: Airflow::Downwash,
    follows_terrain: false,
    is_round: false,
    stride_m: 0.0,
    trail_rgb: [64, 196, 255],
};

/// Controller of one helicopter.
#[derive(Serialize, Deserialize)]
struct Helicopter {
    body: RigidBodyHandle,
    half_height_m: f32,
    rotor_rad: f32,
}

fn half_extents_m(objects: &Objects) -> [f32; 3] {
    objects.half_extents_m(VehicleKind::Helicopter)
}

fn body(objects: &Objects) -> (RigidBodyBuilder, Vec<ColliderBuilder>) {
    let [x, y, z] = half_extents_m(objects);
    let collider = ColliderBuilder::cuboid(x, y, z).mass(MASS_KG).friction(0.9);
    (RigidBodyBuilder::dynamic().can_sleep(false), vec![collider])
}

fn prisms(_: &Objects) -> Vec<Prism> {
    let skid = |x: f32| Prism::runner([x, -1.2, 0.0], [0.15, 0.1, 1.8]);
    vec![Prism::cuboid([0.0, -0.35, 0.0], [0.9, 0.65, 2.6]), skid(-0.95), skid(0.95)]
}

impl Controller for Helicopter {
    fn control(&mut self, drive: Drive, step: &mut ControlStep<'_>) {
        let ControlStep { dt_secs, physics, terrain, .. } = step;
        let dt_secs = *dt_secs;
        self.rotor_rad = (self.rotor_rad + ROTOR_RAD_PER_S * dt_secs) % TAU;
        let body = &mut physics.bodies[self.body];
        let (at, velocity, rotation) = (body.translation(), body.linvel(), *body.rotation());
        let clearance = at.y - self.half_height_m - terrain.height_m([at.x, at.z]);
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

    fn assume(&mut self, _: Rotation, part_rad: f32) {
        self.rotor_rad = part_rad;
    }

    /// Phase of the rotor (rad).
    fn part_rad(&self) -> f32 {
        self.rotor_rad
    }

    fn save(&self) -> Vec<u8> {
        encoded(self)
    }

    fn restore(&mut self, state: &[u8]) -> postcard::Result<()> {
        *self = postcard::from_bytes(state)?;
        Ok(())
    }
}
