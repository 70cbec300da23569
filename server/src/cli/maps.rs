//! `prairie maps`: generates the maps of the built-in scenes.

use super::print::print;
use anyhow::Context as _;
use clap::{Args, ValueHint};
use prairie::escaped::escaped;
use prairie::scenes;
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Example:
  prairie maps --out maps                    writes PNG files into the folder `maps`";

/// Arguments of `prairie maps`.
#[derive(Debug, Args)]
pub(super) struct Maps {
    /// Folder for the PNG files; created if it does not exist
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    out: PathBuf,
}

impl Maps {
    pub(super) fn run(self) -> anyhow::Result<()> {
        let written = scenes::maps::write(&self.out).with_context(|| format!("--out: cannot write the maps to {}", escaped(&self.out)))?;
        print(written.iter().map(escaped).collect::<Vec<_>>().join("\n"))
    }
}
