//! Arguments about where worlds are kept.

use super::number::whole;
use clap::Args;
use prairie::journal::{self, JournalError, JournaledWorld, WorldFolder};
use prairie::scenes::LoadedScene;
use std::ffi::OsString;
use std::path::PathBuf;

/// Folder in which worlds are kept, and its limit.
#[derive(Clone, Debug, Args)]
pub(super) struct WorldArguments {
    /// Folder in which the world is kept, with a sub-folder for each scene; `none` forgets it [default: the user's data folder]
    #[arg(long, env = "PRAIRIE_WORLD", value_name = "DIR|none")]
    world: Option<OsString>,
    /// Size up to which the past of a world is kept (MiB), 16 to 1000000
    #[arg(long, env = "PRAIRIE_WORLD_MB", value_name = "MIB", default_value_t = 256, value_parser = whole(16_u32..=1_000_000))]
    world_mb: u32,
}

impl WorldArguments {
    /// The world of a scene, as it is kept, or a new one. If the user's data folder cannot be written, a world without memory.
    ///
    /// # Errors
    /// Those of a folder that was asked for, and that of one in use.
    pub(super) fn open(&self, scene: &LoadedScene) -> Result<JournaledWorld, JournalError> {
        match journal::open(self.folder().as_ref(), scene) {
            Err(error @ JournalError::File { .. }) if self.world.is_none() => {
                tracing::warn!("{error}; the world is not kept. --world names another folder");
                journal::open(None, scene)
            }
            opened => opened,
        }
    }

    /// The folder; `None` if nothing is to be kept, or the user has no data folder.
    pub(super) fn folder(&self) -> Option<WorldFolder> {
        let path = match &self.world {
            Some(path) if path == "none" => return None,
            Some(path) => PathBuf::from(path),
            None => default_folder()?,
        };
        Some(WorldFolder { path, limit_bytes: u64::from(self.world_mb) << 20 })
    }
}

/// The folder of worlds in the user's data folder.
pub(super) fn default_folder() -> Option<PathBuf> {
    directories::ProjectDirs::from("", "", "prairie").map(|folders| folders.data_dir().join("worlds"))
}
