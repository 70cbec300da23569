//! Memory of a world: a journal of the commands of each step, and checkpoints of the whole state, in a folder of its own.
//!
//! A folder belongs to one scene with its maps. It is a sequence of generations, numbered from 1: the segment `N.journal` begins at the state in
//! `N.checkpoint`, if there is one, and otherwise where the segment before ends. A generation begins with every checkpoint and every start of the server.
//! Everything is checksummed; checkpoints appear completely or not at all. After a crash the newest valid checkpoint is restored and the journal replayed to the
//! step that it had reached, bit for bit, since [`World::step`](crate::world::World::step) depends on state and commands alone.
//!
//! Files are written by threads of their own, behind bounded queues, so the world never waits for a disk. After a full queue or a failed write the journal
//! continues from a new checkpoint.

mod checkpoint;
mod diff;
mod error;
mod folder;
mod health;
mod journaled;
mod player;
mod record;
mod replay;
mod resume;
mod segment;
mod source;
mod unchanged;
mod writer;

pub use checkpoint::{open_checkpoint, seal_checkpoint};
pub use diff::{Difference, compare};
pub use error::{Fault, JournalError};
pub use folder::{Folder, find};
pub use health::Health;
pub use journaled::JournaledWorld;
pub use player::{Player, Recording};
pub use record::{Step, open_record, seal_record};
pub use replay::{Replay, recorded};
pub use resume::open;
pub(crate) use resume::open_or;
pub use segment::Segment;
pub use unchanged::Unchanged;

use std::path::PathBuf;

/// Where and how much of worlds is kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WorldFolder {
    /// Folder with a sub-folder for each scene.
    pub path: PathBuf,
    /// Largest size of a sub-folder (bytes). The oldest generations are deleted first; the newest three are always kept. Default 256 MiB.
    pub limit_bytes: u64,
}

impl WorldFolder {
    /// A folder with the default limit.
    pub fn new(path: PathBuf) -> Self {
        Self { path, limit_bytes: 256 << 20 }
    }
}
