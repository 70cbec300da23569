//! `prairie diff`: the first step at which two journals differ.

use super::print::print;
use clap::{Args, ValueHint};
use prairie::journal::{Difference, compare, recorded};
use std::path::PathBuf;
use std::process::ExitCode;

pub(super) const EXAMPLES: &str = "\
Examples:
  prairie diff worlds-a worlds-b             two copies of a world, or two runs of the same commands

Both are replayed from the first step that they have in common, and compared after every step.
The exit status is 0 if they are equal, 1 if they differ or cannot be read, and 2 for wrong usage.";

/// Arguments of `prairie diff`.
#[derive(Debug, Args)]
pub(super) struct DiffArguments {
    /// Folder of a world, or one with only one world in it
    #[arg(value_name = "A", value_hint = ValueHint::DirPath)]
    one: PathBuf,
    /// Folder of another
    #[arg(value_name = "B", value_hint = ValueHint::DirPath)]
    other: PathBuf,
}

impl DiffArguments {
    pub(super) fn run(self) -> anyhow::Result<ExitCode> {
        let (_, one) = recorded(&self.one, None)?;
        let (_, other) = recorded(&self.other, None)?;
        let ends = [one.recording.end, other.recording.end];
        let Some(difference) = compare(one, other) else {
            print(format!("equal up to their end after step {}", ends[0]))?;
            return Ok(ExitCode::SUCCESS);
        };
        print(match difference {
            Difference::NothingInCommon { steps: [[a, b], [c, d]] } => {
                format!("they have no step in common: one has steps {a} to {b}, the other {c} to {d}")
            }
            Difference::Commands { tick, commands: [one, other] } => {
                format!("step {tick}: the commands differ\n  A: {one:?}\n  B: {other:?}")
            }
            Difference::State { tick, parts } => format!("step {tick}: the same commands, but different {}", parts.join(", ")),
            Difference::Length { ends: [a, b] } => format!("equal as far as both go; A ends after step {a}, B after step {b}"),
        })?;
        Ok(ExitCode::FAILURE)
    }
}
