//! Kinds of vehicles: one file each, and the table of all.

mod ball;
mod car;
mod helicopter;
mod monster;
mod sled;

use super::dynamics::{Airflow, VehicleDynamics};
use super::prism::Prism;
use prairie_core::scene::{Objects, VehicleKind};

pub(super) fn dynamics(kind: VehicleKind) -> &'static VehicleDynamics {
    match kind {
        VehicleKind::Car => &car::DYNAMICS,
        VehicleKind::Monster => &monster::DYNAMICS,
        VehicleKind::Helicopter => &helicopter::DYNAMICS,
        VehicleKind::Sled => &sled::DYNAMICS,
        VehicleKind::Ball => &ball::DYNAMICS,
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

/// Whether the rotation of a kind has no effect on the grass.
pub fn is_round(kind: VehicleKind) -> bool {
    dynamics(kind).is_round
}

/// Colour of a kind's trail in recordings.
pub fn trail_rgb(kind: VehicleKind) -> [u8; 3] {
    dynamics(kind).trail_rgb
}
