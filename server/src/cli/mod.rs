//! The command line: the parts common to all commands, and one file per command.

mod announce;
mod calibrate;
#[cfg(feature = "charts")]
mod chart;
mod check;
mod completions;
mod diff;
mod explain;
#[cfg(feature = "picture")]
mod film;
mod log;
mod manual;
mod maps;
mod new;
mod number;
#[cfg(feature = "picture")]
mod picture;
mod print;
mod replay;
mod run;
mod scenes;
mod schema;
mod serve;
#[cfg(feature = "picture")]
mod shot;
mod stop_signal;
mod tls;
mod unknown_word;
mod usage;
mod version;
#[cfg(not(feature = "charts"))]
mod without_charts;
#[cfg(not(feature = "picture"))]
mod without_picture;
mod world;

use calibrate::Calibrate;
#[cfg(feature = "charts")]
use chart::{Chart, Stability};
use check::Check;
use clap::{Parser, Subcommand};
use completions::Completions;
use diff::DiffArguments;
use explain::Explain;
#[cfg(feature = "picture")]
use film::Film;
use log::LogFormat;
use manual::Manual;
use maps::Maps;
use new::New;
#[cfg(feature = "picture")]
use picture::Picture;
pub(crate) use print::complain;
use replay::ReplayArguments;
use run::Run;
use scenes::Scenes;
use schema::Schema;
use serve::Serve;
use std::process::ExitCode;
#[cfg(not(feature = "charts"))]
use without_charts::{Chart, Stability};
#[cfg(not(feature = "picture"))]
use without_picture::{Film, Picture};

/// A streaming grassland simulator: wind, grass and vehicles, simulated here and drawn in any browser with WebGPU.
#[derive(Debug, Parser)]
#[command(
    name = "prairie",
    version = version::SHORT,
    long_version = version::LONG.as_str(),
    args_conflicts_with_subcommands = true,
    after_help = EXAMPLES
)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    serve: Serve,
}

const EXAMPLES: &str = "\
Without a command, `prairie` means `prairie serve`.

Examples:
  prairie                                    the scene `meadow` on http://127.0.0.1:8080
  prairie --open                             the same, opened in the browser
  prairie storm                              another built-in scene
  prairie my/hills.toml                      a scene of your own
  prairie --addr 0.0.0.0:8443 --tls self     for clients on other machines
  prairie new my                             a scene to start from, my/scene.toml
  prairie check my/hills.toml                its faults, with line and column

A scene that is called like a command is meant by `--scene NAME`.";

#[derive(Debug, Subcommand)]
enum Command {
    /// Simulate a scene and serve it to browsers
    #[command(after_help = serve::EXAMPLES)]
    Serve(Box<Serve>),
    /// Simulate a scene without a page, and write its fields for xarray or ParaView
    #[command(after_help = run::EXAMPLES)]
    Run(Box<Run>),
    /// Play what happened in a world, exactly, for people to watch
    #[command(after_help = replay::EXAMPLES)]
    Replay(ReplayArguments),
    /// Find the first step at which two journals differ
    #[command(after_help = diff::EXAMPLES)]
    Diff(DiffArguments),
    /// List the built-in scenes
    #[command(after_help = scenes::EXAMPLES)]
    Scenes(Scenes),
    /// Check scenes and report their faults with line and column
    #[command(after_help = check::EXAMPLES)]
    Check(Check),
    /// Explain what a scene models: methods, errors, costs, and its plan
    #[command(after_help = explain::EXAMPLES)]
    Explain(Explain),
    /// Measure this machine, for the costs in plans
    #[command(after_help = calibrate::EXAMPLES)]
    Calibrate(Calibrate),
    /// Write a scene to start from, with its maps, into a folder of its own
    #[command(after_help = new::EXAMPLES)]
    New(New),
    /// Print the JSON Schema of scene files, for editors
    #[command(after_help = schema::EXAMPLES)]
    Schema(Schema),
    /// Generate the maps of the built-in scenes; the result is always the same
    #[command(after_help = maps::EXAMPLES)]
    Maps(Maps),
    /// Draw a picture of a scene, without a browser
    #[cfg_attr(feature = "picture", command(after_help = picture::EXAMPLES))]
    Picture(Picture),
    /// Draw a film of a scene, without a browser
    #[cfg_attr(feature = "picture", command(after_help = film::EXAMPLES))]
    Film(Film),
    /// Measure methods on problems with known solutions: error against time
    #[cfg_attr(feature = "charts", command(after_help = chart::CHART_EXAMPLES))]
    Chart(Chart),
    /// Measure where methods fail: maps, and limits beside theory
    #[cfg_attr(feature = "charts", command(after_help = chart::STABILITY_EXAMPLES))]
    Stability(Stability),
    /// Print the script that completes commands, options and files in a shell
    #[command(after_help = completions::EXAMPLES)]
    Completions(Completions),
    /// Print the manual page of Prairie or of one of its commands
    #[command(after_help = manual::EXAMPLES)]
    Man(Manual),
}

/// Parses the arguments and runs the command. Returns the exit status: 0, 1 if a scene is invalid or journals differ, or 2 for wrong arguments or environment variables.
///
/// # Errors
/// Those of the command, for `main` to print.
pub(crate) fn run() -> anyhow::Result<ExitCode> {
    let cli = match usage::parse() {
        Ok(cli) => cli,
        Err(error) => return usage::report(&error),
    };
    let is_named = cli.command.is_some();
    let command = cli.command.unwrap_or_else(|| Command::Serve(Box::new(cli.serve)));
    let format = if let Command::Serve(serve) = &command { serve.log_format } else { LogFormat::default() };
    let filter = match log::filter() {
        Ok(filter) => filter,
        Err(error) => {
            complain(&error);
            return Ok(ExitCode::from(2));
        }
    };
    let _log = log::start(format, filter)?;
    let done = |()| ExitCode::SUCCESS;
    match command {
        Command::Serve(serve) if is_named || !serve.has_word() => serve.run().map(done),
        Command::Serve(serve) => serve.run().map(done).map_err(unknown_word::suggest_commands),
        Command::Run(run) => run.run().map(done),
        Command::Replay(replay) => replay.run().map(done),
        Command::Diff(diff) => diff.run(),
        Command::Scenes(scenes) => scenes.run().map(done),
        Command::Check(check) => check.run(),
        Command::Explain(explain) => explain.run().map(done),
        Command::Calibrate(calibrate) => calibrate.run().map(done),
        Command::New(new) => new.run().map(done),
        Command::Schema(schema) => schema.run().map(done),
        Command::Maps(maps) => maps.run().map(done),
        Command::Picture(picture) => picture.run().map(done),
        Command::Film(film) => film.run().map(done),
        Command::Chart(chart) => chart.run().map(done),
        Command::Stability(stability) => stability.run().map(done),
        Command::Completions(completions) => completions.run().map(done),
        Command::Man(manual) => manual.run().map(done),
    }
}
