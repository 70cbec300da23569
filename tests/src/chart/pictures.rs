//! Draws the pictures of a document again, by the commands that the document states.

use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context as _, Result, ensure};

/// What `picture` stands for in a document.
const PICTURE: [&str; 6] = ["run", "--release", "--features", "picture", "--", "picture"];

/// Arguments of each line `picture …` of a document.
pub fn commands(document: &str) -> Vec<Vec<String>> {
    let lines = document.lines().filter_map(|line| line.strip_prefix("picture "));
    lines.map(|arguments| arguments.split_whitespace().map(str::to_owned).collect()).collect()
}

/// File that a command draws; empty if it names none.
pub fn file(command: &[String]) -> &str {
    command.iter().skip_while(|argument| *argument != "--out").nth(1).map_or("", String::as_str)
}

/// Runs a command at the root of the repository, after a build of the program if it has changed.
///
/// # Errors
/// When the program cannot be built or fails; what it has said is part of the message.
pub fn draw(command: &[String]) -> Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().context("the tests lie in the repository")?;
    let output = Command::new("cargo").args(PICTURE).args(command).current_dir(root).stdin(Stdio::null()).output();
    let output = output.context("cargo does not start")?;
    ensure!(output.status.success(), "{}: {}\n{}", file(command), output.status, String::from_utf8_lossy(&output.stderr));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOCUMENT: &str = include_str!("../../results/README.md");

    #[test]
    fn every_command_draws_the_picture_above_it() {
        let mut above = "";
        let mut found = 0;
        for line in DOCUMENT.lines() {
            if let Some((_, rest)) = line.strip_prefix('!').and_then(|line| line.rsplit_once('(')) {
                above = rest.trim_end_matches(')');
            }
            if line.starts_with("picture ") {
                let command = &commands(line)[0];
                assert_eq!(file(command), format!("tests/results/{above}"));
                found += 1;
            }
        }
        assert!(found > 20 && found == commands(DOCUMENT).len(), "{found} commands");
    }

    #[test]
    fn a_command_names_its_file() {
        assert_eq!(file(&commands("picture --frames 3 --out a.jpg --size 96x54")[0]), "a.jpg");
        assert_eq!(file(&commands("picture --frames 3")[0]), "");
        assert!(commands("a picture of --out a.jpg").is_empty());
    }
}
