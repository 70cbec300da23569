//! Kinds of vehicles: one file each, and the table of all.

mod ball;
mod car;
mod helicopter;
mod monster;
mod sled;
mod walker;

use crate::dynamics::{Airflow, VehicleDynamics};
use prairie_core::body::{Body, Prism};
use prairie_core::scene::{Objects, VehicleKind};

/// Definition of a kind.
pub fn dynamics(kind: VehicleKind) -> &'static VehicleDynamics {
    match kind {
        VehicleKind::Car => &car::DYNAMICS,
        VehicleKind::Monster => &monster::DYNAMICS,
        VehicleKind::Helicopter => &helicopter::DYNAMICS,
        VehicleKind::Sled => &sled::DYNAMICS,
        VehicleKind::Ball => &ball::DYNAMICS,
        VehicleKind::Walker => &walker::DYNAMICS,
    }
}

/// Prisms of a kind that can touch grass, higher ones first.
pub fn prisms(kind: VehicleKind, objects: &Objects) -> Vec<Prism> {
    (dynamics(kind).prisms)(objects)
}

/// Effect of a kind on the air.
pub fn airflow(kind: VehicleKind) -> Airflow {
    dynamics(kind).airflow
}

/// Shapes of all kinds in contact with the grass, in the order of [`VehicleKind::ALL`].
pub fn bodies(objects: &Objects) -> Vec<Body> {
    let body = |kind| {
        let VehicleDynamics { prisms, airflow, is_round, stride_m, .. } = *dynamics(kind);
        Body { prisms: prisms(objects), is_round, has_downwash: airflow == Airflow::Downwash, stride_m }
    };
    VehicleKind::ALL.map(body).to_vec()
}

/// Colour of a kind's trail in recordings.
pub fn trail_rgb(kind: VehicleKind) -> [u8; 3] {
    dynamics(kind).trail_rgb
}
