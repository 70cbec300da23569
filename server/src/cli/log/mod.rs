//! The log on stderr.
//!
//! A thread of its own writes events from a bounded [`queue`], so a stderr that is not read blocks nothing else.

mod queue;
mod text;

use anyhow::Context as _;
use clap::ValueEnum;
pub(super) use queue::Guard;
use queue::Queue;
use std::ffi::OsStr;
use std::io::{IsTerminal as _, stderr};
use std::panic::PanicHookInfo;
use text::Text;
use tracing_subscriber::filter::Targets;
use tracing_subscriber::fmt::MakeWriter;
use tracing_subscriber::{Layer, Registry, fmt, layer::SubscriberExt as _, util::SubscriberInitExt as _};

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

/// Starts the log of the events that pass a filter; dropping the guard writes those that still wait.
///
/// # Errors
/// When the system refuses to start a thread.
pub(super) fn start(format: LogFormat, filter: Targets) -> anyhow::Result<Guard> {
    let is_coloured = is_coloured(stderr().is_terminal(), std::env::var_os("NO_COLOR").as_deref());
    let losses = tracing_subscriber::registry().with(layer(format, is_coloured, stderr)).into();
    let (queue, guard) = Queue::start(stderr(), losses).context("cannot start the thread of the log")?;
    tracing_subscriber::registry().with(layer(format, is_coloured, queue).with_filter(filter)).init();
    std::panic::set_hook(Box::new(log_panic));
    Ok(guard)
}

/// Events to log: those that `RUST_LOG` names, or warnings of all packages and information of Prairie's.
///
/// # Errors
/// When `RUST_LOG` is malformed.
pub(super) fn filter() -> anyhow::Result<Targets> {
    let text = std::env::var("RUST_LOG").unwrap_or_default();
    let filter = if text.is_empty() { "warn,rustls=error,prairie=info" } else { &text };
    filter.parse().with_context(|| {
        format!("RUST_LOG is `{text}`; allowed: levels (off, error, warn, info, debug, trace) and package=level, with commas between")
    })
}

/// Whether to colour the log: on a terminal, unless `NO_COLOR` is set to something.
fn is_coloured(is_terminal: bool, no_color: Option<&OsStr>) -> bool {
    is_terminal && no_color.is_none_or(OsStr::is_empty)
}

/// Writes events to `writer`.
fn layer<W>(format: LogFormat, is_coloured: bool, writer: W) -> Box<dyn Layer<Registry> + Send + Sync>
where
    W: for<'w> MakeWriter<'w> + Send + Sync + 'static,
{
    match format {
        LogFormat::Text => fmt::layer().with_ansi(is_coloured).event_format(Text).with_writer(writer).boxed(),
        LogFormat::Json => {
            fmt::layer().json().flatten_event(true).with_current_span(false).with_span_list(false).with_writer(writer).boxed()
        }
    }
}

/// Logs a panic. The standard hook would block while stderr is not read.
fn log_panic(panic: &PanicHookInfo<'_>) {
    let message = panic.payload_as_str().unwrap_or("no message");
    let place = panic.location().map(ToString::to_string).unwrap_or_default();
    let backtrace = std::backtrace::Backtrace::capture();
    if matches!(backtrace.status(), std::backtrace::BacktraceStatus::Captured) {
        tracing::error!(place, "panic: {message}\n{backtrace}");
    } else {
        tracing::error!(place, "panic: {message}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_terminal_is_coloured_and_only_without_no_color() {
        assert!(is_coloured(true, None) && is_coloured(true, Some(OsStr::new(""))));
        assert!(!is_coloured(true, Some(OsStr::new("1"))) && !is_coloured(false, None));
    }
}
