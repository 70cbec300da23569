//! Motion of a vehicle that a client drives.

use prairie_core::wire::ObjectId;

/// Motion of a client's vehicle in a step, over the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrivenMotion {
    /// The client that drives it.
    pub client: u32,
    /// The vehicle.
    pub object: ObjectId,
    /// X and Z before the step (m).
    pub from_m: [f32; 2],
    /// X and Z after the step (m).
    pub to_m: [f32; 2],
}
