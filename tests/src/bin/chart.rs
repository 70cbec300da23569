//! Measures methods: wall time against error, as files and as a summary on the screen.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, ensure};
use clap::{Args, Parser, Subcommand};
use indicatif::{ProgressBar, ProgressStyle};
use tests::chart::line::{distinct, lines};
use tests::chart::machine::machine;
use tests::chart::plot::{Labels, svg};
use tests::chart::run::{Repeats, measure};
use tests::chart::summary::summary;
use tests::chart::table::markdown;
use tests::chart::{Row, Run, row, wind};
use tests::norms::fitted_order;

/// Measures methods on problems whose answer is known: how long each takes for how small an error.
///
/// Every method solves every problem on grids from coarse to fine. Each run is repeated and its least time kept, in seconds of wall time per simulated second. Written are
/// a chart per problem (SVG, both axes logarithmic), all rows (CSV and JSON) and the order in which each method's error falls (Markdown); printed is which method wins where.
/// Times are only worth something on a machine that does nothing else.
#[derive(Parser)]
#[command(after_help = "Example: cargo run --release -p tests --bin chart -- wind --quick")]
struct Arguments {
    #[command(subcommand)]
    model: Model,
}

#[derive(Subcommand)]
enum Model {
    /// The solvers of the wind, on flows that are known exactly
    Wind(Options),
}

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
        Model::Wind(options) => {
            let words = Words { model: "wind", error: "rms error of velocity (m/s)" };
            chart(&words, wind::runs(options.quick), &options)
        }
    }
}

/// What a model's charts are named and labelled with.
struct Words {
    model: &'static str,
    error: &'static str,
}

fn chart(words: &Words, mut runs: Vec<Run>, options: &Options) -> Result<()> {
    if let Some(word) = &options.only {
        let word = word.to_lowercase();
        runs.retain(|run| run.problem.to_lowercase().contains(&word) || run.method.to_lowercase().contains(&word));
        ensure!(!runs.is_empty(), "--only {word}: no problem or method has this in its name");
    }
    std::fs::create_dir_all(&options.out).with_context(|| format!("{} cannot be made", options.out.display()))?;
    let machine = machine();
    let (rows, failures) = measure_all(words.model, &runs, options.quick);
    write_all(words, &rows, &machine, &options.out)?;
    println!("{}: wall time per simulated second against {}\n{machine}\n", words.model, words.error);
    print!("{}", summary(&rows, "l2"));
    failures.iter().for_each(|failure| println!("failed: {failure}"));
    println!("written to {}", options.out.display());
    Ok(())
}

/// Rows of all runs, and why some gave none.
fn measure_all(model: &str, runs: &[Run], quick: bool) -> (Vec<Row>, Vec<String>) {
    let repeats = if quick { Repeats::QUICK } else { Repeats::THOROUGH };
    let style = ProgressStyle::with_template("{bar:40} {pos}/{len} {msg}").expect("the template is well formed");
    let bar = ProgressBar::new(runs.len() as u64).with_style(style);
    let (mut rows, mut failures) = (Vec::new(), Vec::new());
    for run in runs {
        let name = format!("{}, {}, {}", run.problem, run.method, row::cells_text(run.cells));
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

fn write_all(words: &Words, rows: &[Row], machine: &str, out: &Path) -> Result<()> {
    let model = words.model;
    let write = |name: String, text: String| {
        let path = out.join(name);
        std::fs::write(&path, text).with_context(|| format!("{} cannot be written", path.display()))
    };
    write(format!("{model}.csv"), row::csv(rows))?;
    write(format!("{model}.json"), row::json(rows)?)?;
    write(format!("{model}-orders.md"), orders(rows))?;
    let methods = distinct(rows, |row| &row.method);
    for problem in distinct(rows, |row| &row.problem) {
        let lines = lines(rows, problem, "l2");
        if lines.is_empty() {
            continue;
        }
        let title = format!("{problem}: what accuracy costs");
        let labels = Labels { title: &title, error: words.error, time: "wall time per simulated second (s/s)", caption: machine };
        write(format!("{model}-{}.svg", file_name(problem)), svg(&lines, &methods, labels)?)?;
    }
    Ok(())
}

/// A problem's name in a file's: `Taylor–Green` becomes `taylor-green`.
fn file_name(problem: &str) -> String {
    let words = problem.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    words.map(str::to_lowercase).collect::<Vec<_>>().join("-")
}

/// A table of how fast each method's rms error falls with the spacing, the step falling with it, where at least three grids were run.
fn orders(rows: &[Row]) -> String {
    let mut cells = Vec::new();
    for problem in distinct(rows, |row| &row.problem) {
        for line in lines(rows, problem, "l2").iter().filter(|line| line.rows.len() >= 3) {
            let points: Vec<(f64, f64)> = line.rows.iter().map(|row| (1.0 / row.cells[0] as f64, row.error)).collect();
            let finest = line.rows.last().map_or(f64::NAN, |row| row.error);
            cells.push(vec![problem.to_owned(), line.method.to_owned(), format!("{:.2}", fitted_order(&points)), format!("{finest:.1e}")]);
        }
    }
    markdown(&["problem", "method", "order", "least rms error"], &cells)
}
