//! `prairie completions`: prints the completion script of a shell.

use super::Cli;
use super::print::print;
use clap::{Args, CommandFactory as _};
use clap_complete::Shell;

pub(super) const EXAMPLES: &str = "\
Examples:
  prairie completions bash > ~/.local/share/bash-completion/completions/prairie
  prairie completions zsh > ~/.zfunc/_prairie
                                             with `fpath+=~/.zfunc` before `compinit` in ~/.zshrc
  prairie completions fish > ~/.config/fish/completions/prairie.fish";

/// Arguments of `prairie completions`.
#[derive(Debug, Args)]
pub(super) struct Completions {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

impl Completions {
    pub(super) fn run(self) -> anyhow::Result<()> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Cli::command(), "prairie", &mut script);
        print(String::from_utf8(script)?.trim_end())
    }
}
