//! Measures the figures of the documents and writes their page.

use anyhow::{Context as _, Result, ensure};
use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use std::path::PathBuf;
use std::time::Duration;
use tests::figures::{FIGURES, Figure, Page, measure};

/// Measures speeds, memory and data rates by the commands that the page names, and writes the page.
///
/// All of them take about half an hour. Times are meaningful only on an idle machine.
#[derive(Parser)]
#[command(after_help = EXAMPLES)]
struct Arguments {
    /// Measure only the figures whose quantity or command contains this text; the page keeps the others
    #[arg(long, value_name = "TEXT")]
    only: Option<String>,
    /// List the figures with their commands, and measure nothing
    #[arg(long)]
    list: bool,
    /// Page to write
    #[arg(long, value_name = "FILE", default_value = "tests/results/figures.md")]
    out: PathBuf,
    /// Date of the measurements [default: today, UTC]
    #[arg(long, value_name = "YYYY-MM-DD")]
    date: Option<String>,
}

const EXAMPLES: &str = "\
Examples:
  cargo run --release -p tests --bin figures
  cargo run --release -p tests --bin figures -- --only wind
  cargo run --release -p tests --bin figures -- --list";

fn main() -> Result<()> {
    let Arguments { only, list, out, date } = Arguments::parse();
    let is_wanted = |figure: &&Figure| only.as_ref().is_none_or(|text| figure.quantity.contains(text) || figure.command.contains(text));
    let wanted: Vec<&Figure> = FIGURES.iter().filter(is_wanted).collect();
    if list {
        wanted.iter().for_each(|figure| println!("{}\n    {}", figure.quantity, figure.command));
        return Ok(());
    }
    let date = date.map_or_else(today, Ok)?;
    let mut page = Page::read(&out)?;
    let commands: Vec<&[&Figure]> = wanted.chunk_by(|a, b| a.command == b.command).collect();
    let style = ProgressStyle::with_template("{spinner} {pos}/{len} {msg} ({elapsed})")?;
    let bar = ProgressBar::new(commands.len() as u64).with_style(style);
    bar.enable_steady_tick(Duration::from_millis(200));
    let mut failures = Vec::new();
    for figures in commands {
        bar.set_message(figures[0].command);
        match measure(figures, &date) {
            Ok(measured) => figures.iter().zip(measured).for_each(|(figure, measured)| page.set(figure, measured)),
            Err(error) => failures.push(format!("{error:#}")),
        }
        bar.inc(1);
        // After every command, so that nothing measured is lost.
        std::fs::write(&out, page.text(FIGURES)).with_context(|| out.display().to_string())?;
    }
    bar.finish_and_clear();
    std::fs::write(&out, page.text(FIGURES)).with_context(|| out.display().to_string())?;
    ensure!(failures.is_empty(), "{}", failures.join("\n\n"));
    println!("{}", out.display());
    Ok(())
}

/// Today in UTC, by the system's `date`.
fn today() -> Result<String> {
    let output =
        std::process::Command::new("date").args(["-u", "+%Y-%m-%d"]).output().context("--date: the program `date` did not start")?;
    Ok(String::from_utf8(output.stdout)?.trim().to_owned())
}
