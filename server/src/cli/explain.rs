//! `prairie explain`: what a scene models, by which methods, with which errors and costs, and why.

use super::print::print;
use anyhow::Context as _;
use clap::{Args, ValueHint};
use prairie::plan::fronts::Fronts;
use prairie::plan::{Line, explain};
use prairie::scenes;
use std::ffi::OsString;

pub(super) const EXAMPLES: &str = "\
Examples:
  prairie explain meadow                     methods, errors and costs of a built-in scene
  prairie explain my/hills.toml              and what its [accuracy] and [budget] have planned
  prairie explain --json my/hills.toml       for scripts

Errors come from pilot runs of the scene, which take seconds to minutes the first time; the result is kept.";

/// Arguments of `prairie explain`.
#[derive(Debug, Args)]
pub(super) struct Explain {
    /// Scene file (TOML) or built-in scene
    #[arg(value_name = "SCENE", value_hint = ValueHint::FilePath)]
    scene: OsString,
    /// Print a JSON object
    #[arg(long)]
    json: bool,
}

impl Explain {
    pub(super) fn run(self) -> anyhow::Result<()> {
        let open = scenes::load_open(&self.scene)?;
        let explanation = explain(&open, &Fronts::in_use(), &mut Line::default());
        if self.json {
            return print(serde_json::to_string_pretty(&explanation).context("the explanation cannot be written as JSON")?);
        }
        print(explanation.to_string().trim_end())
    }
}
