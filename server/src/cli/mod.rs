//! The command line: arguments, and one file per command.

mod log;
mod serve;

use anyhow::Context as _;
use clap::{Parser, Subcommand};
use prairie::scenes;
use serve::Serve;
use std::path::{Path, PathBuf};

/// A streaming grassland simulator: wind, grass and vehicles, simulated here and drawn in any browser with WebGPU.
#[derive(Debug, Parser)]
#[command(version, args_conflicts_with_subcommands = true, after_help = EXAMPLES)]
pub(crate) struct Cli {
    #[command(subcommand)]
    action: Option<Action>,
    #[command(flatten)]
    serve: Serve,
}

const EXAMPLES: &str = "\
Without a command, `prairie` means `prairie serve`.

Examples:
  prairie                                    the scene `meadow` on http://127.0.0.1:8080
  prairie --open                             the same, opened in the browser
  prairie serve --scene my/hills.toml        a scene of your own
  prairie serve --addr 0.0.0.0:8443 --tls self
                                             for clients on other machines
  prairie check my/hills.toml                its faults, with line and column";

#[derive(Debug, Subcommand)]
enum Action {
    /// Simulate a scene and serve it to browsers
    #[command(after_help = serve::EXAMPLES)]
    Serve(Serve),
    /// List the built-in scenes
    Scenes,
    /// Check a scene file and report its faults with line and column
    #[command(after_help = "Example:\n  prairie check my/hills.toml\n\nThe exit status is 0 if the scene is valid, otherwise 1.")]
    Check {
        /// Scene file (TOML), or a built-in scene; its maps and models are checked too
        #[arg(value_name = "FILE")]
        scene: String,
    },
    /// Generate the maps of the built-in scenes; the result is always the same
    Maps {
        /// Folder for the PNG files; created if it does not exist
        #[arg(long, value_name = "FOLDER")]
        out: PathBuf,
    },
}

/// Runs the command.
///
/// # Errors
/// Those of the command, for `main` to print.
pub(crate) fn run(cli: Cli) -> anyhow::Result<()> {
    log::start()?;
    match cli.action.unwrap_or(Action::Serve(cli.serve)) {
        Action::Serve(arguments) => serve::serve(arguments),
        Action::Scenes => {
            for (name, summary) in scenes::list() {
                println!("{name:12} {summary}");
            }
            Ok(())
        }
        Action::Check { scene } => scenes::check(&scene).map(|report| println!("{report}")).map_err(Into::into),
        Action::Maps { out } => make_maps(&out),
    }
}

fn make_maps(folder: &Path) -> anyhow::Result<()> {
    let written = scenes::maps::write(folder).with_context(|| format!("cannot write the maps to {}", folder.display()))?;
    for path in written {
        println!("{}", path.display());
    }
    Ok(())
}
