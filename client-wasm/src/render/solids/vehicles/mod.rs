//! Built-in models of the vehicles, one file per kind: shapes of their parts, how the parts move, their headlights, and how they block the wind.

mod ball;
mod car;
mod helicopter;
mod materials;
mod model;
mod monster;
mod sled;
mod walker;

use crate::render::inputs::lamps::SpotLight;
pub(crate) use model::{Motion, VehicleModel, WindBlocking};
use prairie_core::scene::VehicleKind;
use prairie_core::wire::ObjectPose;

/// The model of a kind.
pub(crate) const fn vehicle_model(kind: VehicleKind) -> &'static VehicleModel {
    match kind {
        VehicleKind::Car => &car::MODEL,
        VehicleKind::Monster => &monster::MODEL,
        VehicleKind::Helicopter => &helicopter::MODEL,
        VehicleKind::Sled => &sled::MODEL,
        VehicleKind::Ball => &ball::MODEL,
        VehicleKind::Walker => &walker::MODEL,
    }
}

/// Headlights of all vehicles.
pub(crate) fn headlights(poses: &[ObjectPose]) -> Vec<SpotLight> {
    poses.iter().flat_map(|pose| (vehicle_model(pose.kind).headlights)(pose)).collect()
}
