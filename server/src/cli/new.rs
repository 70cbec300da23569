//! `prairie new`: writes a scene to start from.

use super::print::print;
use clap::{Args, ValueHint};
use prairie::escaped::escaped;
use prairie::scenes::{self, CreateError};
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  prairie new hill                           a hill with a lane over it, a dry pond, trees and stones
  prairie new valley --from meadow           the built-in scene `meadow` with its maps and species

The folder gets scene.toml, the files that it names, and scene.schema.json, by which editors complete and check its fields.";

/// Arguments of `prairie new`.
#[derive(Debug, Args)]
pub(super) struct New {
    /// Folder for the scene: a new one in an existing folder, or an empty one
    #[arg(value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    folder: PathBuf,
    /// Built-in scene to write out, instead of a small commented one; `prairie scenes` lists them
    #[arg(long, value_name = "NAME")]
    from: Option<String>,
}

impl New {
    pub(super) fn run(self) -> anyhow::Result<()> {
        let written = scenes::create(&self.folder, self.from.as_deref());
        let files = written.map_err(|error| {
            let is_from = matches!(error, CreateError::Unknown { .. });
            let error = anyhow::Error::from(error);
            if is_from { error.context("--from") } else { error }
        })?;
        let lines: Vec<_> = files.iter().map(escaped).collect();
        print(format_args!("{}\n\nRun it with: prairie {}", lines.join("\n"), lines[0]))
    }
}
