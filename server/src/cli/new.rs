//! `prairie new`: writes a scene to start from.

use super::print::print;
use clap::{Args, ValueHint};
use prairie::escaped::escaped;
use prairie::scenes::{self, CreateError};
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  prairie new hill                           a hill with a lane over it, a dry pond, trees and stones
  prairie new valley --from meadow           the built-in scene `meadow` with its maps and species

The folder gets scene.toml, the files that it names, and scene.schema.json, by which editors complete and check its fields.";

/// Arguments of `prairie new`.
#[derive(Debug, Args)]
pub(super) struct New {
    /// Folder for the scene: a new one in an existing folder, or an empty one
    #[arg(value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    folder: PathBuf,
    /// Built-in scene to write out, instead of a small commented one; `prairie scenes` lists them
    #[arg(long, value_name = "NAME")]
    from: Option<String>,
}

impl New {
    pub(super) fn run(self) -> anyhow::Result<()> {
        let written = scenes::create(&self.folder, self.from.as_deref());
        let files = written.map_err(|error| {
            let is_from = matches!(error, CreateError::Unknown { .. });
            let error = anyhow::Error::from(error);
            if is_from { error.context("--from") } else { error }
        })?;
        let lines: Vec<_> = files.iter().map(escaped).collect();
        print(format_args!("{}\n\nRun it with: prairie {}", lines.join("\n"), quoted(&lines[0])))
    }
}

/// A path as a word of a command line: in quotes if the shell would not take it as it is.
fn quoted(path: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "/._-+:@%,=".contains(c) || cfg!(windows) && c == '\\';
    match path {
        _ if path.chars().all(is_plain) => path.to_owned(),
        _ if cfg!(windows) => format!("\"{path}\""),
        _ => format!("'{}'", path.replace('\'', r"'\''")),
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn the_shell_takes_a_quoted_path_as_one_word() {
        assert_eq!(quoted("hills/Hügel-1/scene.toml"), "hills/Hügel-1/scene.toml");
        for path in ["a b/scene.toml", "Ada's/scene.toml", "$HOME;*/scene.toml"] {
            let echoed = std::process::Command::new("sh").args(["-c", &format!("printf %s {}", quoted(path))]).output().unwrap();
            assert_eq!(String::from_utf8(echoed.stdout).unwrap(), path);
        }
    }
}
