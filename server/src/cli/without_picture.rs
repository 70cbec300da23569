//! `prairie picture` and `prairie film` in a program that was built without them.

use clap::Args;
use std::ffi::OsString;

/// Arguments of `prairie picture`, which this program lacks.
#[derive(Debug, Args)]
pub(super) struct Picture {
    #[command(flatten)]
    ignored: Ignored,
}

/// Arguments of `prairie film`, which this program lacks.
#[derive(Debug, Args)]
pub(super) struct Film {
    #[command(flatten)]
    ignored: Ignored,
}

#[derive(Debug, Args)]
struct Ignored {
    #[arg(hide = true, trailing_var_arg = true, allow_hyphen_values = true)]
    _arguments: Vec<OsString>,
}

impl Picture {
    pub(super) fn run(&self) -> anyhow::Result<()> {
        missing("picture", &self.ignored)
    }
}

impl Film {
    pub(super) fn run(&self) -> anyhow::Result<()> {
        missing("film", &self.ignored)
    }
}

fn missing(command: &str, _: &Ignored) -> anyhow::Result<()> {
    anyhow::bail!("{command}: this binary was built without the renderer; build it with `--features picture`")
}
