//! What goes over the socket: versioned messages ([`ClientMessage`], [`ServerMessage`]), quantised fields ([`quantise`]) and their codec ([`codec`]).
//!
//! Every binary WebSocket message is one byte of protocol version, [`PROTOCOL`], and a postcard-encoded
//! [`ClientMessage`] or [`ServerMessage`]. Fields travel as 8-bit grids, coded against the frame before (delta) or against zero
//! (key).

mod close;
pub mod codec;
mod message;
pub mod quantise;

pub use close::Close;
pub use codec::{CodecError, Shape};
pub use message::{BrokenPlant, ClientMessage, Drive, Mesh, ObjectId, ObjectPose, Peer, Refusal, ServerMessage, WireError, decode, encode};

/// Version of the protocol; both sides must agree.
pub const PROTOCOL: u8 = 9;

/// Largest message a client may send (bytes).
pub const CLIENT_MESSAGE_LIMIT: usize = 4096;

/// Largest radius of a view (m): farther patches are never sent.
pub const VIEW_RADIUS_LIMIT_M: f32 = 512.0;

/// Most plants of a [`ServerMessage::Broken`].
pub const BROKEN_LIMIT: usize = 4096;

/// Patches that a client keeps at least: those that it was told of last. A server sends deltas only to these.
pub const PATCH_MEMORY: usize = 2048;

/// Largest message a server may send (bytes): a scene with three maps and two models.
pub const SERVER_MESSAGE_LIMIT: usize = 96 << 20;
