//! One vehicle or ball: its body, controller and driver.

use super::autopilot::Autopilot;
use super::dynamics::Controller;
use super::environment::Environment;
use super::terrain_colliders::TerrainColliders;
use prairie_core::body::BodyPose;
use prairie_core::scene::VehicleKind;
use prairie_core::wire::{Drive, ObjectId};
use rapier3d::prelude::*;
use serde::{Deserialize, Serialize};

/// Largest speed of any object (m/s). Faster bodies are slowed down to it.
pub const SPEED_LIMIT_M_PER_S: f32 = 90.0;
/// Height above the terrain at which the autopilot flies (m), and lift input per metre of deviation (1/m).
const CRUISE_M: f32 = 6.0;
const CRUISE_PER_M: f32 = 0.3;

pub(super) struct Vehicle {
    pub(super) id: ObjectId,
    pub(super) kind: VehicleKind,
    pub(super) half_extents_m: [f32; 3],
    pub(super) driver: Driver,
    pub(super) body: RigidBodyHandle,
    pub(super) controller: Box<dyn Controller>,
    /// Pose before the newest step.
    pub(super) previous: BodyPose,
}

#[derive(Clone, Serialize, Deserialize)]
pub(super) enum Driver {
    Client { client: u32, drive: Drive },
    Autopilot(Autopilot),
    None,
}

impl Vehicle {
    /// The driver's present input.
    pub(super) fn input(&mut self, dt_secs: f32, physics: &PhysicsWorld, terrain: &TerrainColliders) -> Drive {
        let body = &physics.bodies[self.body];
        match &mut self.driver {
            Driver::Client { drive, .. } => *drive,
            Driver::None => Drive::default(),
            Driver::Autopilot(autopilot) => {
                let at = body.translation();
                let below_cruise_m = CRUISE_M - (at.y - terrain.height_m([at.x, at.z]));
                let lift = (CRUISE_PER_M * below_cruise_m).clamp(-1.0, 1.0);
                Drive { lift, ..autopilot.drive(body.linvel().length(), dt_secs) }
            }
        }
    }

    /// Keeps the body within the bounds, above the terrain and below [`SPEED_LIMIT_M_PER_S`]. A body whose state is NaN or infinite returns to its
    /// previous pose.
    pub(super) fn confine(&self, body: &mut RigidBody, environment: &Environment, terrain: &TerrainColliders) {
        let (at, velocity) = (body.translation(), body.linvel());
        if !(at.is_finite() && velocity.is_finite() && body.rotation().is_finite() && body.angvel().is_finite()) {
            body.set_enabled(true);
            body.set_translation(Vector::from_array(self.previous.position_m), true);
            body.set_rotation(Rotation::from_array(self.previous.rotation), true);
            body.set_linvel(Vector::ZERO, true);
            body.set_angvel(Vector::ZERO, true);
            return;
        }
        let (mut inside, mut slowed) = (at, velocity.clamp_length_max(SPEED_LIMIT_M_PER_S));
        for (axis, [low, high]) in [0, 2].into_iter().zip(environment.bounds_m()) {
            inside[axis] = at[axis].clamp(low, high);
            if inside[axis] != at[axis] {
                slowed[axis] = 0.0;
            }
        }
        let terrain_m = terrain.height_m([inside.x, inside.z]);
        if inside.y < terrain_m {
            inside.y = terrain_m + self.half_extents_m[1];
            slowed.y = slowed.y.max(0.0);
        }
        if inside != at {
            body.set_translation(inside, true);
        }
        if slowed != velocity {
            body.set_linvel(slowed, true);
        }
    }
}

pub(super) fn pose(body: &RigidBody) -> BodyPose {
    BodyPose { position_m: body.translation().to_array(), rotation: body.rotation().to_array() }
}
