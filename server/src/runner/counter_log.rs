//! Rate limit for log messages about counters.

use crate::log_limit::LogLimit;

/// Value of a rising counter when it was last logged.
#[derive(Default)]
pub(super) struct CounterLog {
    logged: u64,
    limit: LogLimit,
}

impl From<u64> for CounterLog {
    /// A counter that has this value already.
    fn from(logged: u64) -> Self {
        Self { logged, limit: LogLimit::default() }
    }
}

impl CounterLog {
    /// Increase since the last message, if it is not zero and another message is due.
    pub(super) fn increase(&mut self, count: u64) -> Option<u64> {
        if count <= self.logged {
            return None;
        }
        self.limit.due()?;
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
        count.limit = LogLimit::default();
        assert_eq!([3, 6].map(|now| count.increase(now)), [None, Some(3)]);
    }
}
