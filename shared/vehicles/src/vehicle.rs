//! One vehicle or ball among the others of a physics world.

use super::dynamics::{ControlStep, Controller};
use super::environment::Environment;
use super::kinds;
use super::terrain_colliders::TerrainColliders;
use prairie_core::body::BodyPose;
use prairie_core::scene::{Objects, VehicleKind};
use prairie_core::wire::Drive;
use rapier3d::prelude::*;

/// Largest speed of any object (m/s). Faster bodies are slowed down to it.
pub const SPEED_LIMIT_M_PER_S: f32 = 90.0;

/// Body and controller of a vehicle.
///
/// A step of the world [controls](Self::control) each vehicle in turn, advances the physics, and then [confines](Self::confine) each.
pub struct Vehicle {
    /// Its kind.
    pub kind: VehicleKind,
    /// Half the sides of its box (m).
    pub half_extents_m: [f32; 3],
    /// Its rigid body.
    pub body: RigidBodyHandle,
    /// Its controller.
    pub controller: Box<dyn Controller>,
    /// Pose before the newest step.
    pub previous: BodyPose,
}

impl Vehicle {
    /// Adds a vehicle to the physics: its centre at `center_m` (m), its heading from north towards east (rad).
    pub fn insert(kind: VehicleKind, settings: &Objects, center_m: [f32; 3], heading_rad: f32, physics: &mut PhysicsWorld) -> Self {
        let dynamics = kinds::dynamics(kind);
        let (body, colliders) = (dynamics.body)(settings);
        let at = Pose::from_parts(Vector::from_array(center_m), Rotation::from_rotation_y(-heading_rad));
        let body = physics.insert_body(body.pose(at));
        for collider in colliders {
            physics.insert_collider(collider, Some(body));
        }
        // The controls come before the first physics step, which would compute the mass: wheels on the ground push a body without mass to an infinite speed.
        physics.bodies[body].recompute_mass_properties_from_colliders(&physics.colliders);
        let controller = (dynamics.controller)(body, settings, heading_rad);
        let previous = pose(&physics.bodies[body]);
        Self { kind, half_extents_m: settings.half_extents_m(kind), body, controller, previous }
    }

    /// Begins a step: turns the driver's input into forces or velocities of the body.
    pub fn control(&mut self, drive: Drive, step: &mut ControlStep<'_>) {
        self.previous = pose(&step.physics.bodies[self.body]);
        self.controller.control(drive, step);
    }

    /// Ends a step: keeps the body within the bounds, above the terrain and below [`SPEED_LIMIT_M_PER_S`]. A body whose state is NaN or infinite returns to its
    /// previous pose.
    pub fn confine(&self, body: &mut RigidBody, environment: &Environment, terrain: &TerrainColliders) {
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

/// Pose of a body.
pub fn pose(body: &RigidBody) -> BodyPose {
    BodyPose { position_m: body.translation().to_array(), rotation: body.rotation().to_array() }
}
