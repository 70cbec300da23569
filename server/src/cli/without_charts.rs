//! `prairie chart` and `prairie stability` in a program that was built without them.

use clap::Args;
use std::ffi::OsString;

/// Arguments of `prairie chart`, which this program lacks.
#[derive(Debug, Args)]
pub(super) struct Chart {
    #[arg(hide = true, trailing_var_arg = true, allow_hyphen_values = true)]
    _arguments: Vec<OsString>,
}

/// Arguments of `prairie stability`, which this program lacks.
#[derive(Debug, Args)]
pub(super) struct Stability {
    #[arg(hide = true, trailing_var_arg = true, allow_hyphen_values = true)]
    _arguments: Vec<OsString>,
}

impl Chart {
    pub(super) fn run(&self) -> anyhow::Result<()> {
        missing("chart")
    }
}

impl Stability {
    pub(super) fn run(&self) -> anyhow::Result<()> {
        missing("stability")
    }
}

fn missing(command: &str) -> anyhow::Result<()> {
    anyhow::bail!("{command}: this binary was built without the charts; build it with `--features charts`")
}
