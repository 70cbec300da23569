//! Recording of a run for the rerun viewer: fields, objects and metrics.
//!
//! The simulation never waits for a viewer. [`Inspector::observe`] only puts a snapshot into a short queue for a logger thread. When
//! a viewer is slow or frozen, the SDK's calls block that thread, the queue fills, and frames are dropped; their number is logged
//! too. Only this folder depends on rerun, and only with the cargo feature `rerun`.

#![cfg_attr(not(feature = "rerun"), allow(dead_code, reason = "only rerun draws the data gathered here"))]

mod arrows;
mod bend_fields;
mod bend_map;
#[cfg(feature = "rerun")]
mod blueprint;
#[cfg(feature = "rerun")]
mod connect;
mod entities;
mod error;
mod events;
mod inspector;
mod land;
#[cfg(feature = "rerun")]
mod log;
mod outlines;
mod palette;
mod plots;
mod rates;
#[cfg(feature = "rerun")]
mod recording;
mod sink;
mod streamlines;
mod tabs;
mod target;
mod terrain_mesh;
mod trails;
mod wind_fields;
mod window;
#[cfg(feature = "rerun")]
mod write_grass;
#[cfg(feature = "rerun")]
mod write_health;
#[cfg(feature = "rerun")]
mod write_land;
#[cfg(feature = "rerun")]
mod write_objects;
#[cfg(feature = "rerun")]
mod write_wind;

pub use error::InspectError;
pub use inspector::Inspector;
pub use rates::{EntityRate, EntityRateError};
pub use target::{Target, TargetError};
