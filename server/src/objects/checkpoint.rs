//! Copies of the objects' state, from which they continue bit for bit.

use super::Objects;
use super::driver::{Driven, Driver};
use prairie_core::body::BodyPose;
use prairie_core::scene::VehicleKind;
use prairie_core::wire::ObjectId;
use prairie_vehicles::{TileIndex, Vehicle, dynamics};
use rapier3d::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A copy of the state of [`Objects`]: all of the physics, with the colliders of the terrain near the objects, and the drivers.
#[derive(Default, Serialize, Deserialize)]
pub struct ObjectsState {
    physics: PhysicsWorld,
    vehicles: Vec<VehicleState>,
    terrain: BTreeMap<TileIndex, Vec<ColliderHandle>>,
    next_id: ObjectId,
}

#[derive(Serialize, Deserialize)]
struct VehicleState {
    id: ObjectId,
    kind: VehicleKind,
    driver: Driver,
    body: RigidBodyHandle,
    controller: Vec<u8>,
    previous: BodyPose,
}

/// Reason why objects cannot be restored.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ObjectsError {
    /// A vehicle has no body.
    #[error("object {0} has no body")]
    NoBody(ObjectId),
    /// The state of a controller is that of another kind.
    #[error("the controls of object {0} cannot be read: {1}")]
    Controller(ObjectId, postcard::Error),
}

impl Objects {
    /// A copy of the state; shapes are shared.
    pub fn state(&self) -> ObjectsState {
        let vehicle = |Driven { id, driver, vehicle }: &Driven| VehicleState {
            id: *id,
            kind: vehicle.kind,
            driver: driver.clone(),
            body: vehicle.body,
            controller: vehicle.controller.save(),
            previous: vehicle.previous,
        };
        ObjectsState {
            physics: copied(&self.physics),
            vehicles: self.vehicles.iter().map(vehicle).collect(),
            terrain: self.terrain.created().clone(),
            next_id: self.next_id,
        }
    }

    /// Restores a copy of the state in the same scene.
    ///
    /// # Errors
    /// [`ObjectsError`] when the state contradicts itself; nothing changes then.
    pub fn restore(&mut self, state: ObjectsState) -> Result<(), ObjectsError> {
        let settings = &self.settings;
        let vehicle = |VehicleState { id, kind, driver, body, controller, previous }: VehicleState| {
            if !state.physics.bodies.contains(body) {
                return Err(ObjectsError::NoBody(id));
            }
            let mut restored = (dynamics(kind).controller)(body, settings, 0.0);
            restored.restore(&controller).map_err(|error| ObjectsError::Controller(id, error))?;
            let vehicle = Vehicle { kind, half_extents_m: settings.half_extents_m(kind), body, controller: restored, previous };
            Ok(Driven { id, driver, vehicle })
        };
        self.vehicles = state.vehicles.into_iter().map(vehicle).collect::<Result<_, _>>()?;
        self.physics = state.physics;
        self.terrain.restore(state.terrain);
        self.next_id = state.next_id;
        Ok(())
    }
}

/// A copy of the state of a physics world. Its pipelines are work space.
fn copied(physics: &PhysicsWorld) -> PhysicsWorld {
    PhysicsWorld {
        gravity: physics.gravity,
        integration_parameters: physics.integration_parameters,
        islands: physics.islands.clone(),
        broad_phase: physics.broad_phase.clone(),
        narrow_phase: physics.narrow_phase.clone(),
        bodies: physics.bodies.clone(),
        colliders: physics.colliders.clone(),
        impulse_joints: physics.impulse_joints.clone(),
        multibody_joints: physics.multibody_joints.clone(),
        soft_bodies: physics.soft_bodies.clone(),
        ..PhysicsWorld::default()
    }
}
