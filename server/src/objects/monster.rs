//! A monster: a capsule that walks; its speed is set, its feet follow the land.

use super::ground::{Ground, LAND};
use rapier3d::prelude::*;
use shared::wire::Drive;
use std::f32::consts::TAU;

const RUN_M_PER_S: f32 = 7.0;
const BACKWARD_M_PER_S: f32 = 2.5;
const TURN_RAD_PER_S: f32 = 2.4;
/// How fast the walking speed changes (m/s²).
const ACCELERATION_M_PER_S2: f32 = 14.0;
/// Feet this far above the land still walk on it (m).
const STEP_M: f32 = 0.35;
/// Rate at which the feet find the land (1/s).
const FOOTING_PER_S: f32 = 12.0;
/// Ground covered by one cycle of the walk (m).
const STRIDE_M: f32 = 2.2;
/// Steepest climb that is walked at full speed, as rise over run.
const CLIMB: f32 = 1.5;
const RADIUS_M: f32 = 0.6;
const HALF_HEIGHT_M: f32 = 0.9;

/// What drives one monster.
pub(super) struct Monster {
    body: RigidBodyHandle,
    heading_rad: f32,
    phase_rad: f32,
}

/// Body of a monster; it passes the land by, since its feet follow it.
pub(super) fn body() -> (RigidBodyBuilder, ColliderBuilder) {
    let groups = InteractionGroups::new(Group::GROUP_1, Group::ALL & !LAND, InteractionTestMode::And);
    let collider = ColliderBuilder::capsule_y(HALF_HEIGHT_M - RADIUS_M, RADIUS_M).mass(400.0).friction(0.1).collision_groups(groups);
    (RigidBodyBuilder::dynamic().lock_rotations().can_sleep(false), collider)
}

impl Monster {
    pub(super) fn new(body: RigidBodyHandle, heading_rad: f32) -> Self {
        Self { body, heading_rad, phase_rad: 0.0 }
    }

    /// Phase of the walk (rad).
    pub(super) fn phase_rad(&self) -> f32 {
        self.phase_rad
    }

    /// Turns the driver's hands into the body's velocity.
    pub(super) fn control(&mut self, drive: Drive, dt_secs: f32, physics: &mut PhysicsWorld, ground: &Ground) {
        let body = &mut physics.bodies[self.body];
        self.heading_rad = (self.heading_rad + drive.steer * TURN_RAD_PER_S * dt_secs) % TAU;
        body.set_rotation(Rotation::from_rotation_y(-self.heading_rad), true);

        let at = body.translation();
        let (below, slope) = (ground.height_m([at.x, at.z]), ground.slope([at.x, at.z]));
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
}
