//! Causes of a step: everything from outside that acts on the grass. From the same state, the same causes and the same wind give the same bits on every
//! machine, so a client that knows them needs no field.

use super::camera::Camera;
use crate::body::Motion;
use crate::grid::PatchIndex;
use serde::{Deserialize, Serialize};

/// What acted on the grass in one step, except for the wind.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Causes {
    /// Motions of all objects, [rounded](Motion::rounded) and valid.
    pub motions: Vec<Motion>,
    /// Patches that the natural wind pushes, ascending.
    pub gusty: Vec<PatchIndex>,
    /// Patches that sleep because of the limit of awake patches, ascending.
    pub evicted: Vec<PatchIndex>,
    /// Patches whose flattened grass is dropped because of the limit of its tiles, in this order.
    pub dropped: Vec<PatchIndex>,
}

/// Choice of what is given up when a limit of the grass is reached.
#[derive(Clone, Copy, Debug)]
pub(super) enum Limits<'a> {
    /// The farthest from any of these cameras.
    Farthest(&'a [Camera]),
    /// The patches that another simulation has given up.
    Given {
        /// Patches put to sleep.
        evicted: &'a [PatchIndex],
        /// Patches whose flattened grass is dropped.
        dropped: &'a [PatchIndex],
    },
}
