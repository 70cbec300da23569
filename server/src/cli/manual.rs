//! `prairie man`: prints the manual pages.

use super::Cli;
use super::print::print;
use anyhow::Context as _;
use clap::{Args, CommandFactory as _};
use clap_mangen::Man;

pub(super) const EXAMPLES: &str = "\
Examples:
  prairie man | man -l -                     shows the page
  prairie man serve | man -l -               that of `prairie serve`
  prairie man > ~/.local/share/man/man1/prairie.1
                                             installs it for `man prairie`";

/// Arguments of `prairie man`.
#[derive(Debug, Args)]
pub(super) struct Manual {
    /// A command, for its own page
    #[arg(value_name = "COMMAND")]
    command: Option<String>,
}

impl Manual {
    pub(super) fn run(self) -> anyhow::Result<()> {
        let mut prairie = Cli::command().disable_help_subcommand(true);
        prairie.build();
        let page = match &self.command {
            None => &prairie,
            Some(name) => prairie.find_subcommand(name).with_context(|| {
                let known: Vec<_> = prairie.get_subcommands().map(clap::Command::get_name).collect();
                format!("COMMAND is `{name}`; allowed: {}", known.join(", "))
            })?,
        };
        let mut text = Vec::new();
        Man::new(page.clone()).render(&mut text)?;
        print(String::from_utf8(text)?.trim_end())
    }
}
