//! Errors of the files.

use crate::escaped::escaped;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Reasons why results cannot be written.
#[derive(Debug, Error)]
pub enum OutputError {
    /// A file cannot be written.
    #[error("`{}` cannot be written: {reason}", escaped(.path))]
    File {
        /// The file.
        path: PathBuf,
        /// The reason.
        reason: io::Error,
    },
    /// There is something already.
    #[error("`{}` exists; --overwrite replaces it", escaped(.path))]
    Exists {
        /// The file or folder.
        path: PathBuf,
    },
    /// There is something else, which is never replaced.
    #[error("`{}` exists and is no {kind} of an earlier run, so it is not replaced; name another", escaped(.path))]
    NotOurs {
        /// The file or folder.
        path: PathBuf,
        /// What it should be.
        kind: &'static str,
    },
    /// A variable is too large to be held in memory.
    #[error("`{field}` has {values} values at a time in this scene; allowed: at most {most}. Leave it out with --fields")]
    TooLarge {
        /// Word of the field.
        field: &'static str,
        /// Its values at one time.
        values: usize,
        /// The limit.
        most: usize,
    },
    /// The scene has no such field.
    #[error("`dust` is asked for, and the scene releases none: its `wind.dust.release_per_s` is 0. Leave it out of --fields")]
    NoDust,
    /// A station is not on the land.
    #[error("station `{name}` is at {at_m:?}; allowed: 0 to {} m along X and 0 to {} m along Z", .extent_m[0], .extent_m[1])]
    Station {
        /// Name of the station.
        name: String,
        /// Its position along X and Z (m).
        at_m: [f32; 2],
        /// Extent of the land (m).
        extent_m: [f32; 2],
    },
    /// Two stations have the same name.
    #[error("two stations are called `{0}`; each needs a name of its own")]
    SameName(String),
    /// The system refuses the thread that writes.
    #[error("cannot start the thread that writes files: {0}")]
    Thread(io::Error),
    /// A store cannot be written.
    #[error("the Zarr store `{}` cannot be written: {reason}", escaped(.path))]
    Zarr {
        /// The store.
        path: PathBuf,
        /// The reason.
        reason: String,
    },
}

impl OutputError {
    /// The error of a file at `path`.
    pub(super) fn file(path: &Path) -> impl Fn(io::Error) -> Self + '_ {
        |reason| Self::File { path: path.to_owned(), reason }
    }
}
