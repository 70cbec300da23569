//! `prairie scenes`: lists the built-in scenes.

use super::print::print;
use anyhow::Context as _;
use clap::{Args, ValueEnum};
use prairie::scenes::{self, SceneDescription};

pub(super) const EXAMPLES: &str = "\
Examples:
  prairie scenes                             the names, with a summary of each and its methods
  prairie scenes --format json               with maps, size and what each shows, for scripts
  prairie storm                              serves one of them";

/// Arguments of `prairie scenes`.
#[derive(Debug, Args)]
pub(super) struct Scenes {
    /// Format of the list: names, summaries and the methods that each scene shows, or a JSON list with an object for each scene
    #[arg(long, value_enum, value_name = "FORMAT", default_value_t)]
    format: Format,
}

/// Format of the list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum Format {
    #[default]
    Text,
    Json,
}

impl Scenes {
    pub(super) fn run(self) -> anyhow::Result<()> {
        match self.format {
            Format::Text => {
                let lines: Vec<_> = scenes::catalogue().iter().map(entry).collect();
                print(lines.join("\n"))
            }
            Format::Json => print(serde_json::to_string_pretty(&scenes::catalogue()).context("the list cannot be written as JSON")?),
        }
    }
}

/// Name and summary of a scene, and below them its methods other than the default ones.
fn entry(scene: &SceneDescription) -> String {
    let SceneDescription { name, summary, methods, .. } = scene;
    let methods: String = methods.iter().map(|method| format!("\n{:12}   {method}", "")).collect();
    format!("{name:12} {summary}{methods}")
}
