//! Reasons why a world's folder cannot be used, and faults of its files.

use crate::escaped::escaped;
use crate::settings_error::SettingsError;
use crate::world::RestoreError;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Reason why a world's folder cannot be used.
#[derive(Debug, Error)]
pub enum JournalError {
    /// Another process uses the folder.
    #[error("{}: another server keeps the world of this scene here; stop it, or choose another folder with --world", escaped(.0))]
    Busy(PathBuf),
    /// A file or folder cannot be read or written.
    #[error("{}: {error}", escaped(.path))]
    File {
        /// The file or folder.
        path: PathBuf,
        /// The system's reason.
        error: io::Error,
    },
    /// The folder is not that of a world.
    #[error("{}: {reason}", escaped(.path))]
    NoWorld {
        /// The folder.
        path: PathBuf,
        /// What is missing.
        reason: String,
    },
    /// The scene's constants contradict each other.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The system refused to start a thread.
    #[error("cannot start the threads of the journal: {0}")]
    Threads(io::Error),
}

impl JournalError {
    /// An error of a file.
    pub(super) fn file(path: &Path, error: io::Error) -> Self {
        Self::File { path: path.to_owned(), error }
    }
}

/// Fault of a checkpoint, a segment or a record.
#[derive(Debug, Error)]
pub enum Fault {
    /// The file cannot be read.
    #[error("it cannot be read: {0}")]
    Unreadable(#[from] io::Error),
    /// The file begins with other bytes.
    #[error("it is not a file of this kind and version")]
    Kind,
    /// The bytes end too soon.
    #[error("it is truncated")]
    Truncated,
    /// The checksum is that of other bytes.
    #[error("its checksum is wrong")]
    Checksum,
    /// The checksum is right, but the content cannot be decoded.
    #[error("it cannot be decoded")]
    Content,
    /// The state is that of another scene.
    #[error(transparent)]
    Restore(#[from] RestoreError),
}
