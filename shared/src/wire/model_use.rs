//! The use of a model that a scene brings along.

use crate::scene::VehicleKind;
use serde::{Deserialize, Serialize};

/// Use of a [`Mesh`](super::Mesh) of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ModelUse {
    /// Drawn for all vehicles of this kind.
    Vehicle(VehicleKind),
    /// Drawn in each box of the scene's [model](crate::scene::Scene::models) of this index, at its mean size.
    Cover(u8),
}
