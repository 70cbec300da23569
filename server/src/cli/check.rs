//! `prairie check`: reports the faults of scenes.

use super::print::{complain, print};
use anyhow::Context as _;
use clap::{Args, ValueEnum, ValueHint};
use prairie::escaped::escaped;
use prairie::scenes::{self, Report, SceneError};
use serde::Serialize;
use std::ffi::{OsStr, OsString};
use std::process::ExitCode;

pub(super) const EXAMPLES: &str = "\
Examples:
  prairie check my/hills.toml                one scene of your own
  prairie check my/*.toml storm              several, and a built-in one
  prairie check --format json my/*.toml      for editors and scripts

Drawings of faults and summaries of valid scenes go to stdout, unreadable files to stderr.
The exit status is 0 if all scenes are valid, 1 if any is not, and 2 for wrong usage.";

/// Most faults of a scene in JSON, the first ones; the others are counted.
const LISTED_LIMIT: usize = 1000;

/// Arguments of `prairie check`.
#[derive(Debug, Args)]
pub(super) struct Check {
    /// Scene files (TOML) or built-in scenes; the maps and models that they name are checked too
    #[arg(value_name = "SCENE", required = true, value_hint = ValueHint::FilePath)]
    scenes: Vec<OsString>,
    /// Format of the report: drawings and summaries, or a JSON list with an object for each scene
    #[arg(long, value_enum, value_name = "FORMAT", default_value_t)]
    format: Format,
}

/// Format of the report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum Format {
    #[default]
    Text,
    Json,
}

impl Check {
    pub(super) fn run(self) -> anyhow::Result<ExitCode> {
        let are_valid = match self.format {
            Format::Text => self.draw()?,
            Format::Json => self.list()?,
        };
        Ok(if are_valid { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }

    /// Draws the faults of each scene, and returns whether all are valid.
    fn draw(&self) -> anyhow::Result<bool> {
        let mut are_valid = true;
        for (number, scene) in self.scenes.iter().enumerate() {
            let text = match scenes::check(scene) {
                Ok(report) => report.to_string(),
                Err(error) => {
                    are_valid = false;
                    let SceneError::Faulty(faulty) = error else {
                        complain(&error.into());
                        continue;
                    };
                    faulty.styled().trim_end().to_owned()
                }
            };
            print(if number == 0 { text } else { format!("\n{text}") })?;
        }
        Ok(are_valid)
    }

    /// Lists the faults of each scene, and returns whether all are valid.
    fn list(&self) -> anyhow::Result<bool> {
        let checked: Vec<_> = self.scenes.iter().map(|scene| Checked::new(scene, scenes::check(scene))).collect();
        print(serde_json::to_string_pretty(&checked).context("the report cannot be written as JSON")?)?;
        Ok(checked.iter().all(|scene| scene.valid))
    }
}

/// A checked scene in JSON; server/README.md describes the fields.
#[derive(Serialize)]
struct Checked {
    file: String,
    valid: bool,
    faults: Vec<Fault>,
    more_faults: usize,
    error: Option<String>,
}

/// A fault in JSON.
#[derive(Serialize)]
struct Fault {
    file: String,
    line: usize,
    column: usize,
    length: usize,
    path: String,
    message: String,
}

impl Checked {
    fn new(scene: &OsStr, outcome: Result<Report, SceneError>) -> Self {
        let mut checked = Self { file: escaped(scene), valid: outcome.is_ok(), faults: Vec::new(), more_faults: 0, error: None };
        match outcome {
            Ok(_) => {}
            Err(SceneError::Faulty(faulty)) => {
                checked.more_faults = faulty.faults.len().saturating_sub(LISTED_LIMIT);
                let listed = faulty.faults.into_iter().take(LISTED_LIMIT).map(|fault| Fault {
                    file: faulty.file.clone(),
                    line: fault.line,
                    column: fault.column,
                    length: fault.length,
                    path: fault.path,
                    message: fault.message,
                });
                checked.faults = listed.collect();
            }
            Err(error) => checked.error = Some(error.to_string()),
        }
        checked
    }
}
