//! The log on stderr.

use anyhow::Context as _;
use std::io::IsTerminal as _;
use tracing_subscriber::filter::Targets;
use tracing_subscriber::{Layer as _, fmt, layer::SubscriberExt as _, util::SubscriberInitExt as _};

/// Starts the log.
///
/// # Errors
/// When `RUST_LOG` is malformed.
pub(crate) fn start() -> anyhow::Result<()> {
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
