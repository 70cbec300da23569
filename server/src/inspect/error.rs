//! Errors of a recording.

use crate::escaped::escaped;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;
use thiserror::Error;

/// Reasons why a run cannot be recorded.
#[derive(Debug, Error)]
pub enum InspectError {
    /// The address to serve at is in use, or does not belong to this machine.
    #[error("cannot serve the recording at {addr}: {reason}; choose another port with --rerun serve=PORT")]
    Address {
        /// The requested address.
        addr: SocketAddr,
        /// The system's reason.
        reason: std::io::Error,
    },
    /// The file cannot be written.
    #[error("cannot write the recording to {}: {reason}", escaped(path))]
    File {
        /// The requested file.
        path: PathBuf,
        /// The system's reason.
        reason: std::io::Error,
    },
    /// The end of the file is missing, for example because the disk is full.
    #[error("the recording {} has no footer; the disk may be full", escaped(path))]
    NoFooter {
        /// The file.
        path: PathBuf,
    },
    /// No viewer listens at the address.
    #[error("no viewer listens at {url}: {reason}; start one with `rerun` first")]
    NoViewer {
        /// The requested address.
        url: String,
        /// The system's reason.
        reason: std::io::Error,
    },
    /// The rerun SDK reported an error.
    #[error("rerun: {0}")]
    Sdk(String),
    /// The logger did not finish in time, for example because the viewer froze.
    #[error("the recording {target} was not finished within {} s; its end may be missing", waited.as_secs())]
    Unfinished {
        /// Destination of the recording.
        target: String,
        /// How long the server waited.
        waited: Duration,
    },
    /// This program was built without the feature `rerun`.
    #[error("this program was built without rerun; build it with the cargo feature `rerun`")]
    NotBuilt,
}
