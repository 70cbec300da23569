//! Monster: a walking capsule. Its velocity is set directly, and its feet follow the terrain.

use crate::dynamics::{Airflow, ControlStep, Controller, VehicleDynamics, encoded, heading_rad};
use crate::terrain_colliders::TERRAIN;
use prairie_core::body::Prism;
use prairie_core::scene::Objects;
use prairie_core::wire::Drive;
use rapier3d::prelude::*;
use serde::{Deserialize, Serialize};
use std::f32::consts::TAU;

const RUN_M_PER_S: f32 = 7.0;
const BACKWARD_M_PER_S: f32 = 2.5;
const TURN_RAD_PER_S: f32 = 2.4;
/// Rate of change of the walking speed (m/s²).
const ACCELERATION_M_PER_S2: f32 = 14.0;
/// Clearance below which the feet still walk on the terrain (m).
const STEP_M: f32 = 0.35;
/// Rate at which the feet approach the terrain (1/s).
const FOOTING_PER_S: f32 = 12.0;
/// Distance of one walk cycle (m).
const STRIDE_M: f32 = 2.2;
/// Steepest slope that is climbed at full speed, as rise over run.
const CLIMB: f32 = 1.5;
const RADIUS_M: f32 = 0.6;
const HALF_HEIGHT_M: f32 = 0.9;

pub(super) const DYNAMICS: VehicleDynamics = VehicleDynamics {
    body,
    controller: |body, _, heading_rad| Box::new(Monster { body, heading_rad, phase_rad: 0.0 }),
    prisms: |_| vec![Prism::post(RADIUS_M, [-HALF_HEIGHT_M, HALF_HEIGHT_M])],
    airflow: Airflow::Wake,
    follows_terrain: true,
    is_round: false,
    stride_m: 0.0,
    trail_rgb: [186, 104, 255],
};

/// Controller of one monster.
#[derive(Serialize, Deserialize)]
struct Monster {
    body: RigidBodyHandle,
    heading_rad: f32,
    phase_rad: f32,
}

/// The body does not collide with the terrain, since the feet follow it.
fn body(_: &Objects) -> (RigidBodyBuilder, Vec<ColliderBuilder>) {
    let groups = InteractionGroups::new(Group::GROUP_1, Group::ALL & !TERRAIN, InteractionTestMode::And);
    let collider = ColliderBuilder::capsule_y(HALF_HEIGHT_M - RADIUS_M, RADIUS_M).mass(400.0).friction(0.1).collision_groups(groups);
    (RigidBodyBuilder::dynamic().lock_rotations().can_sleep(false), vec![collider])
}

impl Controller for Monster {
    fn control(&mut self, drive: Drive, step: &mut ControlStep<'_>) {
        let ControlStep { dt_secs, physics, terrain, .. } = step;
        let dt_secs = *dt_secs;
        let body = &mut physics.bodies[self.body];
        self.heading_rad = (self.heading_rad + drive.steer * TURN_RAD_PER_S * dt_secs) % TAU;
        body.set_rotation(Rotation::from_rotation_y(-self.heading_rad), true);

        let at = body.translation();
        let (below, slope) = (terrain.height_m([at.x, at.z]), terrain.slope([at.x, at.z]));
        let clearance = at.y - HALF_HEIGHT_M - below;
        let mut velocity = body.linvel();
        if clearance < STEP_M {
            let speed = if drive.throttle < 0.0 { BACKWARD_M_PER_S } else { RUN_M_PER_S };
            let walk = speed * drive.throttle * (1.0 - drive.brake);
            let wanted = Vector::new(self.heading_rad.sin() * walk, 0.0, -self.heading_rad.cos() * walk);
            let rise = (slope[0] * wanted.x + slope[1] * wanted.z) / walk.abs().max(0.01);
            let change = wanted / (rise / CLIMB).max(1.0) - Vector::new(velocity.x, 0.0, velocity.z);
            velocity += change.clamp_length_max(ACCELERATION_M_PER_S2 * dt_secs);
            velocity.y = slope[0] * velocity.x + slope[1] * velocity.z - clearance * FOOTING_PER_S.min(1.0 / dt_secs);
        }
        body.set_linvel(velocity, true);
        body.set_gravity_scale(if clearance < STEP_M { 0.0 } else { 1.0 }, true);
        let covered = velocity.x.hypot(velocity.z) * dt_secs;
        self.phase_rad = (self.phase_rad + covered * TAU / STRIDE_M) % TAU;
    }

    fn assume(&mut self, rotation: Rotation, part_rad: f32) {
        (self.heading_rad, self.phase_rad) = (heading_rad(rotation), part_rad);
    }

    /// Phase of the walk (rad).
    fn part_rad(&self) -> f32 {
        self.phase_rad
    }

    fn save(&self) -> Vec<u8> {
        encoded(self)
    }

    fn restore(&mut self, state: &[u8]) -> postcard::Result<()> {
        *self = postcard::from_bytes(state)?;
        Ok(())
    }
}
