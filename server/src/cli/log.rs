//! The log on stderr.

use anyhow::Context as _;
use clap::ValueEnum;
use std::io::IsTerminal as _;
use tracing_subscriber::filter::Targets;
use tracing_subscriber::{Layer as _, fmt, layer::SubscriberExt as _, util::SubscriberInitExt as _};

/// Format of the log.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum LogFormat {
    // Plain comments, since documented values would make clap space out all of `--help`.
    // A line of text for each event.
    #[default]
    Text,
    // A JSON object on a line for each event.
    Json,
}

/// Starts the log.
///
/// # Errors
/// When `RUST_LOG` is malformed.
pub(super) fn start(_: LogFormat) -> anyhow::Result<()> {
    let format = fmt::layer().with_target(false).with_ansi(std::io::stderr().is_terminal()).with_writer(std::io::stderr);
    tracing_subscriber::registry().with(format.with_filter(filter()?)).init();
    Ok(())
}

/// Events to log: those that `RUST_LOG` names, or warnings of all packages and information of Prairie's.
fn filter() -> anyhow::Result<Targets> {
    let text = std::env::var("RUST_LOG").unwrap_or_default();
    let filter = if text.is_empty() { "warn,prairie=info" } else { &text };
    filter.parse().with_context(|| {
        format!("RUST_LOG is `{text}`; allowed: levels (off, error, warn, info, debug, trace) and package=level, with commas between")
    })
}
