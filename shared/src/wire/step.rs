//! Causes of a step of the grass on the wire, as differences from the step before.

use super::ObjectId;
use crate::body::PoseCode;
use crate::grid::PatchIndex;
use crate::scene::VehicleKind;
use serde::{Deserialize, Serialize};

/// A step in which something changes, apart from the [moves](Move) of its objects.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepHead {
    /// Number of steps before it, since the one before in the message, in which nothing changes.
    pub quiet_before: u16,
    /// Causes that few steps have.
    pub rare: Option<Box<RareCauses>>,
}

/// Motion of an object in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Move {
    /// The pose stays the same; the object is at rest or not, as before.
    Same,
    /// The pose stays the same; whether the object is now at rest.
    Rest(bool),
    /// The pose changes, and the object is not at rest.
    Moved(PoseChange),
    /// The pose changes although the object is at rest.
    MovedAtRest(PoseChange),
}

/// Change of a pose in a step, minus the change in the step before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PoseChange {
    /// Of the position's [code](PoseCode), modulo 2³².
    pub position: [i32; 3],
    /// Of the rotation's code, modulo 2¹⁶.
    pub rotation: [i16; 4],
    /// Of the moving part's angle in 65536ths of a turn, modulo a turn.
    pub part: i16,
}

/// Causes that few steps have.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RareCauses {
    /// Objects that have left.
    pub left: Vec<ObjectId>,
    /// Objects that have joined, ascending by number, above all others.
    pub joined: Vec<Joined>,
    /// Patches that the natural wind pushes, ascending, if they differ from those of the step before.
    pub gusty: Option<Vec<PatchIndex>>,
    /// Patches put to sleep because of the limit of awake patches, ascending.
    pub evicted: Vec<PatchIndex>,
    /// Patches whose flattened grass is dropped because of the limit of its tiles, in this order.
    pub dropped: Vec<PatchIndex>,
    /// Checksums of patches after the step.
    pub checks: Vec<PatchCheck>,
}

/// A new object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Joined {
    /// Number of the object.
    pub id: ObjectId,
    /// Kind of the object.
    pub kind: VehicleKind,
    /// Pose before the step.
    pub from: PoseCode,
}

/// Checksum of a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PatchCheck {
    /// Index of the patch.
    pub patch: PatchIndex,
    /// Checksum of its grass after the step.
    pub sum: u16,
}
