//! `prairie check`: reports the faults of scenes.

use super::print::{complain, print};
use clap::{Args, ValueHint};
use prairie::scenes;
use std::ffi::OsString;
use std::process::ExitCode;

pub(super) const EXAMPLES: &str = "\
Examples:
  prairie check my/hills.toml                one scene of your own
  prairie check my/*.toml storm              several, and a built-in one

The exit status is 0 if all scenes are valid, 1 if any is invalid or cannot be read, 2 for wrong usage.";

/// Arguments of `prairie check`.
#[derive(Debug, Args)]
pub(super) struct Check {
    /// Scene files (TOML) or built-in scenes; the maps and models that they name are checked too
    #[arg(value_name = "SCENE", required = true, value_hint = ValueHint::FilePath)]
    scenes: Vec<OsString>,
}

impl Check {
    pub(super) fn run(self) -> anyhow::Result<ExitCode> {
        let mut status = ExitCode::SUCCESS;
        for scene in &self.scenes {
            match scenes::check(scene) {
                Ok(report) => print(report)?,
                Err(error) => {
                    complain(&error.into());
                    status = ExitCode::FAILURE;
                }
            }
        }
        Ok(status)
    }
}
