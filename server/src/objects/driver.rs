//! Drivers of vehicles: clients, the autopilot, or none.

use super::autopilot::Autopilot;
use prairie_core::scene::VehicleKind;
use prairie_core::wire::{AppliedInput, Drive, ObjectId};
use prairie_vehicles::{TerrainColliders, Vehicle};
use rapier3d::prelude::*;
use serde::{Deserialize, Serialize};

/// Height above the terrain at which the autopilot flies (m), and lift input per metre of deviation (1/m).
const CRUISE_M: f32 = 6.0;
const CRUISE_PER_M: f32 = 0.3;
/// Lift input with which a walker runs.
const RUNS: f32 = -1.0;

/// A vehicle with its number and its driver.
pub(super) struct Driven {
    pub(super) id: ObjectId,
    pub(super) driver: Driver,
    pub(super) vehicle: Vehicle,
}

#[derive(Clone, Serialize, Deserialize)]
pub(super) enum Driver {
    Client { client: u32, drive: Drive, applied: AppliedInput },
    Autopilot(Autopilot),
    None,
}

impl Driver {
    /// A client that has sent no input yet.
    pub(super) fn client(client: u32) -> Self {
        Self::Client { client, drive: Drive::default(), applied: AppliedInput::default() }
    }
}

impl Driven {
    /// The driver's present input.
    pub(super) fn input(&mut self, dt_secs: f32, physics: &PhysicsWorld, terrain: &TerrainColliders) -> Drive {
        let body = &physics.bodies[self.vehicle.body];
        match &mut self.driver {
            Driver::Client { drive, .. } => *drive,
            Driver::None => Drive::default(),
            Driver::Autopilot(autopilot) => {
                let at = body.translation();
                let below_cruise_m = CRUISE_M - (at.y - terrain.height_m([at.x, at.z]));
                let lift = match self.vehicle.kind {
                    VehicleKind::Helicopter => (CRUISE_PER_M * below_cruise_m).clamp(-1.0, 1.0),
                    VehicleKind::Walker => RUNS,
                    _ => 0.0,
                };
                Drive { lift, ..autopilot.drive(body.linvel().length(), dt_secs) }
            }
        }
    }
}
