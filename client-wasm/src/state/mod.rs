//! The client's mirror of the server: every [`ServerMessage`](prairie_core::wire::ServerMessage) is applied to it, and the renderer reads it.
//!
//! Messages come from the network and are not trusted: lengths, indices and numbers are checked before anything is stored. Memory is bounded by
//! [`PATCH_LIMIT`], [`OBJECT_LIMIT`], [`PEER_LIMIT`] and the number of plant sites.

mod broken_plants;
mod check;
mod check_underbrush;
mod checkpoint;
mod error;
mod fields;
mod following;
mod mirror;
mod past;
mod playback;
mod playback_clock;
mod race;
mod record;
mod sample;
mod scene;
mod seen_motion;

pub use error::MirrorError;
pub use fields::{PATCH_LIMIT, PatchCodes, ShownWind, WindCodes};
pub use mirror::{Event, Mirror, PEER_LIMIT, WIND_DELAY_SECS};
pub use past::Past;
pub use playback::OBJECT_LIMIT;
pub use record::{CHECKPOINT_SECS, RECORD_LIMIT_BYTES, RECORD_SECS, Record};
pub use scene::DecodedScene;
pub use seen_motion::SeenMotion;

#[cfg(test)]
mod tests;
