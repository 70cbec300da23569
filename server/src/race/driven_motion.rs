//! Motion of a vehicle that a client drives.

use prairie_core::body::BodyPose;
use prairie_core::scene::VehicleKind;
use prairie_core::wire::ObjectId;

/// Motion of a client's vehicle in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrivenMotion {
    /// The client that drives it.
    pub client: u32,
    /// The vehicle.
    pub object: ObjectId,
    /// Its kind.
    pub kind: VehicleKind,
    /// Pose before the step.
    pub from: BodyPose,
    /// Pose after the step.
    pub to: BodyPose,
}
