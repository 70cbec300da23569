//! State of the journal's files, shared by the world's thread, the writers and the metrics.

use crate::metrics::JournalStats;
use std::sync::Mutex;
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
    /// Generation of the segment that cannot be written; 0 if the newest one can.
    pub(super) broken_generation: AtomicU64,
    is_failing: AtomicBool,
    newest_failure: Mutex<String>,
}

impl Health {
    /// Counts a failed write, and logs the first of a row.
    pub(super) fn fail(&self, what: &str, error: &std::io::Error) {
        self.failures.fetch_add(1, Relaxed);
        if let Ok(mut newest) = self.newest_failure.lock() {
            *newest = format!("{what} cannot be written: {error}");
        }
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

    /// Whether the newest write of a segment or a checkpoint has failed.
    pub(super) fn is_failing(&self) -> bool {
        self.is_failing.load(Relaxed) || self.broken_generation.load(Relaxed) != 0
    }

    /// The newest failure while the journal or its checkpoints cannot be written; a crash would then lose steps.
    pub fn failure(&self) -> Option<String> {
        self.is_failing().then(|| self.newest_failure.lock().map(|newest| newest.clone()).unwrap_or_default())
    }

    /// The counters at this moment.
    pub fn stats(&self) -> JournalStats {
        JournalStats {
            bytes: self.journal_bytes.load(Relaxed),
            checkpoints: self.checkpoints.load(Relaxed),
            failures: self.failures.load(Relaxed),
            lost_steps: self.lost_steps.load(Relaxed),
            copy_max_secs: self.copy_max_us.load(Relaxed) as f64 / 1e6,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Error, ErrorKind};

    #[test]
    fn a_failure_is_reported_until_segment_and_checkpoint_can_be_written() {
        let health = Health::default();
        assert_eq!(health.failure(), None);
        health.broken_generation.store(7, Relaxed);
        health.fail("the journal of the world", &Error::new(ErrorKind::StorageFull, "no space"));
        assert_eq!(health.failure().as_deref(), Some("the journal of the world cannot be written: no space"));
        health.succeed();
        assert!(health.failure().is_some(), "a checkpoint without a segment after it");
        health.broken_generation.store(0, Relaxed);
        assert_eq!(health.failure(), None);
        assert_eq!(health.stats(), JournalStats { failures: 1, checkpoints: 1, ..JournalStats::default() });
    }
}
