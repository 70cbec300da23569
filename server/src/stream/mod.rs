//! Streaming of snapshots to clients: areas of interest, shared encoding, and back-pressure by acknowledgement.
//!
//! Each grid (a patch of the bend field, or the wind) has a sequence of numbered frames, [`GridFrames`]. A frame is encoded at most
//! twice, as a delta and as a key, when the first client needs it; all clients share the bytes. A client that holds the previous frame
//! gets the delta, any other client the key. A slow client that misses a frame needs a key later, at no cost to the others.
//!
//! Broken plants are an ordered list that only grows; the streamer remembers how many of them each client has been sent.
//!
//! Patches outside every area of interest cost nothing: their frames are dropped after a while. For each client the streamer remembers
//! only the patches sent last, no more than any client keeps; other patches are sent as keys.
//!
//! A client that asks for a replica of the grass gets its state and from then on the causes of each step ([`StepLog`]) instead of patches and poses. Causes
//! are never skipped: a client that lags gets them later, and one that lags too far starts again.
//!
//! A client has at most a few unacknowledged frames in flight ([`SendLimits`]). Until it acknowledges one it is skipped, and then gets
//! the newest state: nothing queues.

mod announcement;
mod area;
mod client_state;
mod clients;
mod encoder;
mod following;
mod grid_frames;
mod step_log;
mod streamer;

pub use area::{PATCH_LIMIT, patches_near};
pub use client_state::{ClientState, Publication, SendLimits};
pub use clients::{AreaOfInterest, Client, Clients, Difference, Frame, Progress};
pub use encoder::Encoder;
pub use following::Following;
pub use grid_frames::{FrameHeader, Grid, GridFrames};
pub use step_log::StepLog;
pub use streamer::{Counters, Stream, Streamer, start};
