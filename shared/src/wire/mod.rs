//! Wire format: versioned messages ([`ClientMessage`], [`ServerMessage`]), quantised fields ([`quantise`]) and their codec ([`codec`]).
//!
//! Every binary WebSocket message is one byte of protocol version, [`PROTOCOL`], followed by a postcard-encoded [`ClientMessage`] or
//! [`ServerMessage`]. Fields are sent as 8-bit grids, coded as differences from the previous frame (delta frame) or from zero (key frame).

mod close;
pub mod codec;
mod message;
mod model_use;
mod protocol;
pub mod quantise;
mod step;
mod turbulence_state;

pub use close::Close;
pub use codec::{CodecError, Shape};
pub use message::{
    AppliedInput, BrokenPlant, ClientMessage, Drawing, Drive, Ghost, Mesh, ObjectId, ObjectPose, PROOF_BYTES, Peer, Refusal, ServerMessage,
    Shapes, Standing, WireError, decode, encode,
};
pub use model_use::ModelUse;
pub use protocol::PROTOCOL;
pub use step::{Joined, Move, PatchCheck, PoseChange, RareCauses, StepHead};
pub use turbulence_state::TurbulenceState;

/// Largest message a client may send (bytes).
pub const CLIENT_MESSAGE_LIMIT: usize = 4096;

/// Largest radius of a view (m): farther patches are never sent.
pub const VIEW_RADIUS_LIMIT_M: f32 = 512.0;

/// Largest number of plants in a [`ServerMessage::Broken`].
pub const BROKEN_LIMIT: usize = 4096;

/// Largest number of clients in a [`ServerMessage::Race`]: all who drive where a scene does not raise the limit of objects.
pub const STANDINGS_LIMIT: usize = 64;

/// Largest number of poses of a [`Ghost`]: 205 s at 10 Hz. A longer lap has none.
pub const GHOST_LIMIT: usize = 2048;

/// Number of most recently received patches that a client keeps at least. A server sends deltas only to these.
pub const PATCH_MEMORY: usize = 2048;

/// Largest message a server may send (bytes): a scene with three maps, the models of two vehicles, and those of the covering map.
pub const SERVER_MESSAGE_LIMIT: usize = 96 << 20;
