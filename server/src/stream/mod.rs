//! From snapshots to frames: interest, encode once, share; pacing by acknowledgement.
//!
//! Each grid (a patch of the bend field, the wind) is a [`Track`] of numbered frames. A frame is encoded at most twice, as a
//! delta and as a key, when the first client needs it; all clients share the bytes. A client that holds the frame before gets the delta,
//! any other the key, so a frame that a slow client misses costs it a key later and nobody else anything.
//!
//! Broken plants are an ordered list that only grows: of each client the streamer remembers how many of them a frame has told it.
//!
//! What nobody looks at costs nothing: the frames of a patch that no client has asked for of late are dropped, and of a client the streamer
//! remembers only the patches that it was sent last, no more than any client keeps. Any other patch it is sent as a key.
//!
//! A client has at most a few frames on their way ([`SendLimits`]); while they are not acknowledged it is skipped, and
//! then gets the newest state: nothing queues.

mod clients;
mod encoder;
mod interest;
mod pace;
mod streamer;
mod track;

pub use clients::{Client, Clients, Frame, Gaze};
pub use encoder::{DEAD_BAND, Encoder, SLOW_HZ, WIND_HZ};
pub use interest::{PATCH_LIMIT, interest};
pub use pace::{Common, Pace, SendLimits};
pub use streamer::{Counters, Stream, Streamer, start};
pub use track::{Grid, Numbering, Pacing, Track};
