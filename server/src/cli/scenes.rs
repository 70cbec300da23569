//! `prairie scenes`: lists the built-in scenes.

use super::print::print;
use clap::Args;
use prairie::scenes;

pub(super) const EXAMPLES: &str = "\
Examples:
  prairie scenes                             the names, with a summary of each
  prairie storm                              serves one of them";

/// Arguments of `prairie scenes`.
#[derive(Debug, Args)]
pub(super) struct Scenes {}

impl Scenes {
    pub(super) fn run(self) -> anyhow::Result<()> {
        let lines: Vec<_> = scenes::list().map(|(name, summary)| format!("{name:12} {summary}")).collect();
        print(lines.join("\n"))
    }
}
