//! Measures methods: wall time against error, as files and as a summary on the screen.

use std::path::PathBuf;

use anyhow::{Result, ensure};
use clap::{Args, Parser, Subcommand};
use indicatif::{ProgressBar, ProgressStyle};
use tests::chart::files::write_all;
use tests::chart::machine::machine;
use tests::chart::row::cells_text;
use tests::chart::run::{Repeats, measure};
use tests::chart::summary::summary;
use tests::chart::{Row, Run, wind};

/// Measures methods on problems whose answer is known: how long each takes for how small an error.
///
/// Every method solves every problem on grids from coarse to fine. Each run is repeated and its least time kept, in seconds of wall time per simulated second.
/// Printed is which method wins where. Times are only worth something on a machine that does nothing else.
#[derive(Parser)]
#[command(after_help = EXAMPLES)]
struct Arguments {
    #[command(subcommand)]
    model: Model,
}

const EXAMPLES: &str = "\
Examples:
  cargo run --release -p tests --bin chart -- wind
  cargo run --release -p tests --bin chart -- wind --quick --only MacCormack --out /tmp/charts";

#[derive(Subcommand)]
enum Model {
    /// The solvers of the wind, on flows that are known exactly
    #[command(after_help = FILES)]
    Wind(Options),
}

const FILES: &str = "\
Files in DIR:
  wind-PROBLEM.svg   error across, time up, both logarithmic; one line per method, further left
                     and down is better; the Pareto front, which nothing beats, is highlighted
  wind.csv, .json    every figure: model, problem, method, cells, dt_secs, norm (l1, l2 = root mean
                     square, linf), error (m/s), seconds (wall time per simulated second)
  wind-orders.md     order in which each method's error falls as grid and time step are refined

On the screen, for each problem and a few errors: the method that gets there in the least time, read
from its line between two runs, and by how much the next one takes longer.";

#[derive(Args)]
struct Options {
    /// Folder the files are written to
    #[arg(long, value_name = "DIR", default_value = "target/charts")]
    out: PathBuf,
    /// Coarse grids and few repeats: seconds instead of minutes, for a look
    #[arg(long)]
    quick: bool,
    /// Only problems and methods with this word in their name
    #[arg(long, value_name = "WORD")]
    only: Option<String>,
}

fn main() -> Result<()> {
    match Arguments::parse().model {
        Model::Wind(options) => chart("wind", "rms error of velocity (m/s)", wind::runs(options.quick), &options),
    }
}

fn chart(model: &str, error: &str, mut runs: Vec<Run>, options: &Options) -> Result<()> {
    if let Some(word) = &options.only {
        let has = |name: &str| name.to_lowercase().contains(&word.to_lowercase());
        runs.retain(|run| has(run.problem) || has(&run.method));
        ensure!(!runs.is_empty(), "--only {word}: no problem or method has this in its name");
    }
    let machine = machine();
    let (rows, failures) = measure_all(model, &runs, if options.quick { Repeats::QUICK } else { Repeats::THOROUGH });
    let files = write_all(model, &rows, error, &machine, &options.out)?;
    println!("{model}: wall time per simulated second against {error}\n{machine}\n");
    print!("{}", summary(&rows, "l2"));
    failures.iter().for_each(|failure| println!("failed: {failure}"));
    println!("{} files in {}", files.len(), options.out.display());
    Ok(())
}

/// Rows of all runs, and why some gave none.
fn measure_all(model: &str, runs: &[Run], repeats: Repeats) -> (Vec<Row>, Vec<String>) {
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {elapsed} {wide_msg}").expect("the template is well formed");
    let bar = ProgressBar::new(runs.len() as u64).with_style(style);
    let (mut rows, mut failures) = (Vec::new(), Vec::new());
    for run in runs {
        let name = format!("{}, {}, {}", run.problem, run.method, cells_text(run.cells));
        bar.set_message(name.clone());
        match measure(model, run, repeats) {
            Ok(measured) => rows.extend(measured),
            Err(error) => failures.push(format!("{name}: {error:#}")),
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    (rows, failures)
}
