//! State of the journal's files, shared by the world's thread, the writers and the metrics.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

/// Counters of a journal.
#[derive(Debug, Default)]
pub struct Health {
    /// Bytes of records written.
    pub journal_bytes: AtomicU64,
    /// Checkpoints written.
    pub checkpoints: AtomicU64,
    /// Failed writes of segments and checkpoints.
    pub failures: AtomicU64,
    /// Steps that are missing in the journal because of a full queue or a failed write; a checkpoint follows.
    pub lost_steps: AtomicU64,
    /// Duration of the longest copy of the state within a step (µs).
    pub copy_max_us: AtomicU64,
    /// Whether the present segment cannot be written.
    pub(super) is_broken: AtomicBool,
    is_failing: AtomicBool,
}

impl Health {
    /// Counts a failed write, and logs the first of a row.
    pub(super) fn fail(&self, what: &str, error: &std::io::Error) {
        self.failures.fetch_add(1, Relaxed);
        if !self.is_failing.swap(true, Relaxed) {
            tracing::error!("{what} cannot be written: {error}; until it can be again, a crash loses what happens");
        }
    }

    /// Notes a successful checkpoint.
    pub(super) fn succeed(&self) {
        self.checkpoints.fetch_add(1, Relaxed);
        if self.is_failing.swap(false, Relaxed) {
            tracing::info!("the world is kept again");
        }
    }
}
