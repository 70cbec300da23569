//! Recording of a run for the rerun viewer: fields, objects and metrics.
//!
//! The simulation never waits for a viewer. [`Inspector::observe`] only puts a snapshot into a short queue for a logger thread. When
//! a viewer is slow or frozen, the SDK's calls block that thread, the queue fills, and frames are dropped; their number is logged
//! too. Only this folder depends on rerun, and only with the cargo feature `rerun`.

#![cfg_attr(not(feature = "rerun"), allow(dead_code, reason = "only rerun draws the data gathered here"))]

mod arrows;
mod bend_map;
#[cfg(feature = "rerun")]
mod blueprint;
#[cfg(feature = "rerun")]
mod connect;
mod error;
mod inspector;
mod palette;
mod plots;
#[cfg(feature = "rerun")]
mod recording;
mod sink;
mod target;
mod terrain_mesh;
mod trails;

pub use error::InspectError;
pub use inspector::Inspector;
pub use target::{Target, TargetError};
