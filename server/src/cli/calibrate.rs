//! `prairie calibrate`: measures the times of the wind's methods on this machine, for plans.

use super::print::print;
use anyhow::Context as _;
use clap::{Args, ValueHint};
use prairie::plan::{Line, calibrate, fronts};
use std::fs;
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  prairie calibrate                          measures, and keeps the times in the user's configuration folder
  prairie calibrate --out fronts.json        keeps them elsewhere

It takes about half a minute, in which the machine should do nothing else.";

/// Arguments of `prairie calibrate`.
#[derive(Debug, Args)]
pub(super) struct Calibrate {
    /// File of the times [default: fronts.json in the user's configuration folder]
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    out: Option<PathBuf>,
}

impl Calibrate {
    pub(super) fn run(self) -> anyhow::Result<()> {
        let path = self.out.or_else(fronts::file).context("the user has no configuration folder; --out names a file")?;
        let mut line = Line::default();
        let measured = calibrate(|done, all| line.bar("measuring", done, all));
        drop(line);
        let failed = || format!("the times cannot be written to `{}`", path.display());
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).with_context(failed)?;
        }
        fs::write(&path, serde_json::to_string_pretty(&measured)? + "\n").with_context(failed)?;
        print(format!("{}\n{}: {} methods in {} boxes", path.display(), measured.machine, measured.ns.len(), measured.cells.len()))
    }
}
