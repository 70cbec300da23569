//! Running the commands of the figures.

use super::Figure;
use anyhow::{Context as _, Result, ensure};
use prairie_charts::machine::machine;
use std::path::Path;
use std::process::{Command, Stdio};

/// A measured figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// As printed by the command.
    pub figure: String,
    /// Date (UTC) and machine.
    pub when_and_where: String,
}

/// Runs the command of `figures`, which they share, in the workspace; returns the figures in their order.
///
/// # Errors
/// When the command fails, or its output lacks a figure; the message ends with the output's last lines.
pub fn measure(figures: &[&Figure], date: &str) -> Result<Vec<Measured>> {
    let command = figures.first().context("no figure")?.command;
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).parent().context("tests is a folder of the workspace")?;
    let mut words = command.split_whitespace();
    let run = Command::new(words.next().context("an empty command")?)
        .args(words)
        .current_dir(workspace)
        .stdin(Stdio::null())
        .output()
        .with_context(|| format!("`{command}` did not start"))?;
    let output = format!("{}\n{}", String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    let last_lines = || output.lines().rev().take(12).collect::<Vec<_>>().into_iter().rev().collect::<Vec<_>>().join("\n");
    ensure!(run.status.success(), "`{command}` failed ({}):\n{}", run.status, last_lines());
    let when_and_where = format!("{date}, {}", machine());
    let find = |figure: &&Figure| {
        let found = figure.pick.find(&output).with_context(|| format!("{}: `{command}` printed\n{}", figure.quantity, last_lines()))?;
        Ok(Measured { figure: found, when_and_where: when_and_where.clone() })
    };
    figures.iter().map(find).collect()
}

#[cfg(test)]
mod tests {
    use super::super::Pick;
    use super::*;

    const fn figure(command: &'static str, text: &'static str) -> Figure {
        Figure { quantity: "words", aim: "", command, pick: Pick::After(text) }
    }

    #[test]
    fn a_command_is_run_once_for_all_its_figures() -> Result<()> {
        let (one, two) = (figure("echo one: 1, two: 2", "two: "), figure("echo one: 1, two: 2", "one: "));
        let measured = measure(&[&one, &two], "2026-01-02")?;
        assert_eq!([measured[0].figure.as_str(), measured[1].figure.as_str()], ["2", "1, two: 2"]);
        assert!(measured[0].when_and_where.starts_with("2026-01-02, "));
        Ok(())
    }

    #[test]
    fn failures_show_the_command_and_its_output() {
        let told = |figure: &Figure| format!("{:#}", measure(&[figure], "").expect_err("it fails"));
        assert!(told(&figure("no-such-program", "")).contains("`no-such-program` did not start"));
        assert!(told(&figure("false", "")).contains("`false` failed"));
        let missing = told(&figure("echo nothing here", "speed"));
        assert!(
            missing.contains("words: `echo nothing here` printed\nnothing here") && missing.contains("no line contains `speed`"),
            "{missing}"
        );
    }
}
