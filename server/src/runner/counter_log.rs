//! Rate limit for log messages about counters.

use std::time::{Duration, Instant};

/// Minimum time between two log messages about the same counter.
const LOG_INTERVAL: Duration = Duration::from_secs(10);

/// Value of a rising counter when it was last logged.
#[derive(Default)]
pub(super) struct CounterLog {
    logged: u64,
    logged_at: Option<Instant>,
}

impl CounterLog {
    /// Increase since the last message, if it is not zero and another message is due.
    pub(super) fn increase(&mut self, count: u64) -> Option<u64> {
        if count <= self.logged || self.logged_at.is_some_and(|at| at.elapsed() <= LOG_INTERVAL) {
            return None;
        }
        self.logged_at = Some(Instant::now());
        Some(count - std::mem::replace(&mut self.logged, count))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rising_counter_is_logged_once_in_a_while() {
        let mut count = CounterLog::default();
        assert_eq!([0, 3, 5].map(|now| count.increase(now)), [None, Some(3), None]);
        count.logged_at = None;
        assert_eq!([3, 6].map(|now| count.increase(now)), [None, Some(3)]);
    }
}
