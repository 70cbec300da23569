//! The program as its users see it: help texts, messages, output, log and exit status.

mod check;
mod environment;
#[cfg(unix)]
mod log;
mod new;
#[cfg(unix)]
mod output;
mod program;
#[cfg(all(unix, feature = "rerun"))]
mod recording;
mod scene;
mod snapshots;
mod tls;
