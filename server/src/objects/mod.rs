//! Vehicles and balls: rigid bodies, drivers, and free positions for new ones.
//!
//! Rigid-body dynamics are rapier's, on one thread and in the order of the object numbers, so the same commands give the same bits.

mod autopilot;
pub mod built_in_models;
mod checkpoint;
mod driver;
pub mod gltf;
mod spawn;

pub use checkpoint::{ObjectsError, ObjectsState};
pub use prairie_vehicles::Environment;
pub use spawn::center_for;

use crate::checksum::Checksum;
use crate::race::DrivenMotion;
use autopilot::Autopilot;
use driver::{Driven, Driver};
use prairie_core::body::{BodyPose, Motion};
use prairie_core::scene::{self, Scene, VehicleKind};
use prairie_core::wire::{AppliedInput, Drive, ObjectId, ObjectPose};
use prairie_vehicles::{ControlStep, TerrainColliders, Vehicle, dynamics, pose};
use rapier3d::prelude::*;
use spawn::Disc;
use std::collections::BTreeMap;

/// Gap between a new object's box and the ground (m).
const DROP_M: f32 = 0.05;
/// Distance between the scene's balls, approximately (m).
const BALL_SPACING_M: f32 = 6.0;

/// All vehicles and balls.
pub struct Objects {
    environment: Environment,
    terrain: TerrainColliders,
    physics: PhysicsWorld,
    vehicles: Vec<Driven>,
    settings: scene::Objects,
    next_id: ObjectId,
}

impl Objects {
    /// The scene's self-driving vehicles and balls at their starting positions.
    pub fn new(scene: &Scene, environment: Environment) -> Self {
        let terrain = TerrainColliders::new(&environment, scene);
        let mut physics = PhysicsWorld::new();
        physics.integration_parameters.dt = scene.dt_secs();
        let mut objects = Self { environment, terrain, physics, vehicles: vec![], settings: scene.objects.clone(), next_id: 1 };
        let center = objects.environment.extent_m.map(|extent| 0.5 * extent);
        let scene::Objects { self_driving, self_driving_m_per_s, self_driving_apart_m, self_driving_kind, balls, .. } = scene.objects;
        for n in 0..self_driving {
            objects.add(self_driving_kind, Driver::Autopilot(Autopilot::new(n, self_driving_m_per_s)), center, self_driving_apart_m);
        }
        let [east, south] = scene.camera.at;
        let start = [objects.environment.extent_m[0] * east, objects.environment.extent_m[1] * south];
        for _ in 0..balls {
            objects.add(VehicleKind::Ball, Driver::None, start, BALL_SPACING_M);
        }
        objects
    }

    /// Gives `client` a vehicle near `center_m` in place of its previous one. Returns `None` when the limit is reached or no position is free.
    pub fn spawn(&mut self, client: u32, kind: VehicleKind, center_m: [f32; 2]) -> Option<ObjectId> {
        self.remove(client);
        self.add(kind, Driver::client(client), center_m, spawn::NEAR_M)
    }

    /// Removes the vehicle of `client`.
    pub fn remove(&mut self, client: u32) {
        if let Some(slot) = self.slot_of(client) {
            let vehicle = self.vehicles.remove(slot);
            self.physics.remove_body(vehicle.vehicle.body);
        }
    }

    /// Sets the input of the vehicle of `client`, which stays until the next call: its number by the client, and the step in which it first has effect. An invalid
    /// [`Drive`] is ignored.
    pub fn drive(&mut self, client: u32, input: Drive, applied: AppliedInput) {
        if let Some(slot) = self.slot_of(client)
            && let Driver::Client { drive, applied: newest, .. } = &mut self.vehicles[slot].driver
            && input.is_valid()
        {
            (*drive, *newest) = (input, applied);
        }
    }

    /// The newest input of each client with a vehicle that has sent any.
    pub fn applied_inputs(&self) -> BTreeMap<u32, AppliedInput> {
        let applied = self.vehicles.iter().filter_map(|vehicle| match vehicle.driver {
            Driver::Client { client, applied, .. } => Some((client, applied)),
            Driver::Autopilot(_) | Driver::None => None,
        });
        applied.filter(|(_, applied)| applied.number != 0).collect()
    }

    /// Limit of the number of objects.
    pub fn limit(&self) -> u32 {
        self.settings.limit
    }

    /// The vehicle of `client`.
    pub fn object_of(&self, client: u32) -> Option<ObjectId> {
        self.slot_of(client).map(|slot| self.vehicles[slot].id)
    }

    /// Clients that have a vehicle, ascending by vehicle.
    pub fn drivers(&self) -> impl Iterator<Item = u32> {
        self.vehicles.iter().filter_map(|vehicle| match vehicle.driver {
            Driver::Client { client, .. } => Some(client),
            Driver::Autopilot(_) | Driver::None => None,
        })
    }

    /// Advances all objects by `dt_secs`, given the wind (m/s) as a function of position (m).
    pub fn step(&mut self, dt_secs: f32, wind_m_per_s: impl Fn([f32; 3]) -> [f32; 3]) {
        if self.is_empty() && self.terrain.is_empty() {
            return;
        }
        let positions: Vec<_> = self.vehicles.iter().map(|driven| pose(&self.physics.bodies[driven.vehicle.body]).xz()).collect();
        self.terrain.follow(&positions, &mut self.physics);
        for driven in &mut self.vehicles {
            let drive = driven.input(dt_secs, &self.physics, &self.terrain);
            let (physics, terrain) = (&mut self.physics, &self.terrain);
            driven.vehicle.control(drive, &mut ControlStep { dt_secs, physics, terrain, wind_m_per_s: &wind_m_per_s });
        }
        self.physics.step();
        for Driven { vehicle, .. } in &self.vehicles {
            vehicle.confine(&mut self.physics.bodies[vehicle.body], &self.environment, &self.terrain);
        }
    }

    /// Whether there are no objects.
    pub fn is_empty(&self) -> bool {
        self.vehicles.is_empty()
    }

    /// Poses of all objects, ascending by number.
    pub fn poses(&self) -> Vec<ObjectPose> {
        let object_pose = |Driven { id, vehicle, .. }: &Driven| {
            let body = &self.physics.bodies[vehicle.body];
            let BodyPose { position_m, rotation } = pose(body);
            let velocity_m_per_s = body.linvel().to_array();
            let part_rad = vehicle.controller.part_rad();
            ObjectPose { id: *id, kind: vehicle.kind, position_m, rotation, velocity_m_per_s, part_rad }
        };
        self.vehicles.iter().map(object_pose).collect()
    }

    /// Numbers of all objects, ascending, and angles of their moving parts (rad).
    pub fn parts(&self) -> impl Iterator<Item = (ObjectId, f32)> {
        self.vehicles.iter().map(|driven| (driven.id, driven.vehicle.controller.part_rad()))
    }

    /// Motions of all objects in the newest step.
    pub fn motions(&self) -> Vec<Motion> {
        let motion = |Driven { vehicle, .. }: &Driven| {
            let body = &self.physics.bodies[vehicle.body];
            Motion {
                kind: vehicle.kind,
                from: vehicle.previous,
                to: pose(body),
                velocity_m_per_s: body.linvel().to_array(),
                part_rad: vehicle.controller.part_rad(),
                is_at_rest: body.is_sleeping(),
            }
        };
        self.vehicles.iter().map(motion).collect()
    }

    /// Motions of the vehicles of clients, given [all motions](Self::motions) of the newest step.
    pub fn driven(&self, motions: &[Motion]) -> impl Iterator<Item = DrivenMotion> {
        self.vehicles.iter().zip(motions).filter_map(|(vehicle, motion)| match vehicle.driver {
            Driver::Client { client, .. } => {
                Some(DrivenMotion { client, object: vehicle.id, kind: motion.kind, from: motion.from, to: motion.to })
            }
            Driver::Autopilot(_) | Driver::None => None,
        })
    }

    /// Adds the poses to a checksum.
    pub(crate) fn hash(&self, sum: &mut Checksum) {
        for pose in self.poses() {
            sum.add([pose.id]);
            sum.add(pose.position_m.iter().chain(&pose.rotation).chain(&pose.velocity_m_per_s).map(|v| v.to_bits()));
        }
    }

    fn slot_of(&self, client: u32) -> Option<usize> {
        self.vehicles.iter().position(|vehicle| matches!(vehicle.driver, Driver::Client { client: other, .. } if other == client))
    }

    fn add(&mut self, kind: VehicleKind, driver: Driver, center_m: [f32; 2], spacing_m: f32) -> Option<ObjectId> {
        if self.vehicles.len() >= self.settings.limit as usize {
            return None;
        }
        let disc = |Driven { vehicle: other, .. }: &Driven| {
            let at_m = pose(&self.physics.bodies[other.body]).xz();
            Disc { at_m, radius_m: radius_m(other.half_extents_m) }
        };
        let taken: Vec<_> = self.vehicles.iter().map(disc).collect();
        let half_extents_m = self.settings.half_extents_m(kind);
        let at_m = spawn::find(center_m, spacing_m, radius_m(half_extents_m), &taken, &self.terrain, &self.environment)?;
        let heading_rad = (at_m[0] - center_m[0]).atan2(center_m[1] - at_m[1]);
        let reach_m = if dynamics(kind).follows_terrain { 0.0 } else { 0.7 * radius_m(half_extents_m) };
        let center_m = [at_m[0], self.highest_within(at_m, reach_m) + half_extents_m[1] + DROP_M, at_m[1]];
        let vehicle = Vehicle::insert(kind, &self.settings, center_m, heading_rad, &mut self.physics);
        let id = self.next_id;
        self.next_id += 1;
        self.vehicles.push(Driven { id, driver, vehicle });
        Some(id)
    }

    /// Highest terrain (m) at a position and at the corners of the square of half side `reach_m` around it.
    fn highest_within(&self, [x, z]: [f32; 2], reach: f32) -> f32 {
        let around = [[x, z], [x - reach, z - reach], [x + reach, z - reach], [x - reach, z + reach], [x + reach, z + reach]];
        around.into_iter().map(|at| self.terrain.height_m(at)).fold(f32::NEG_INFINITY, f32::max)
    }
}

/// Radius (m) of the circle around a box, seen from above.
fn radius_m([x, _, z]: [f32; 3]) -> f32 {
    x.hypot(z)
}
