//! `prairie man`: prints the manual pages.

use super::Cli;
use super::print::print;
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
    #[arg(value_name = "COMMAND", value_parser = name_of_command)]
    command: Option<String>,
}

impl Manual {
    pub(super) fn run(self) -> anyhow::Result<()> {
        let mut prairie = Cli::command().disable_help_subcommand(true);
        prairie.build();
        let page = match &self.command {
            None => &prairie,
            Some(name) => prairie.find_subcommand(name).expect("the parser of the argument knows it"),
        };
        let mut text = Vec::new();
        Man::new(page.clone()).render(&mut text)?;
        print(String::from_utf8(text)?.trim_end())
    }
}

fn name_of_command(text: &str) -> Result<String, String> {
    let prairie = Cli::command();
    let known: Vec<_> = prairie.get_subcommands().map(clap::Command::get_name).collect();
    if known.contains(&text) { Ok(text.to_owned()) } else { Err(format!("allowed: {}", known.join(", "))) }
}
