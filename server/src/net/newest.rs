//! Rate limit for messages of one kind: a newer message replaces one that waits.

use crate::token_bucket::TokenBucket;
use std::time::{Duration, Instant};

/// The newest message of a kind, until the rate limit allows it; a newer one replaces it.
#[derive(Debug)]
pub(super) struct Newest<T> {
    waiting: Option<T>,
    allowance: TokenBucket,
}

impl<T> Newest<T> {
    /// At most `per_s` messages per second, with bursts of twice this number and at least one.
    pub(super) fn new(per_s: f64, now: Instant) -> Self {
        Self { waiting: None, allowance: TokenBucket::new((2.0 * per_s).max(1.0), per_s, now) }
    }

    /// Replaces the waiting message.
    pub(super) fn put(&mut self, message: T) {
        self.waiting = Some(message);
    }

    pub(super) fn is_waiting(&self) -> bool {
        self.waiting.is_some()
    }

    /// The waiting message, if it may be carried out now.
    pub(super) fn take_due(&mut self, now: Instant) -> Option<T> {
        self.allowance.fill(now);
        if self.waiting.is_some() && self.allowance.try_take(1.0) { self.waiting.take() } else { None }
    }

    /// Time until the waiting message may be carried out; `None` if none waits.
    pub(super) fn wait(&self) -> Option<Duration> {
        self.waiting.as_ref().map(|_| self.allowance.wait(1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn after_a_burst_only_the_newest_is_carried_out() {
        let start = Instant::now();
        let mut newest = Newest::new(2.0, start);
        let mut taken = Vec::new();
        for ms in 0..2000_u64 {
            newest.put(ms);
            taken.extend(newest.take_due(start + Duration::from_millis(ms)));
        }
        assert_eq!(taken[..4], [0, 1, 2, 3], "a burst of four");
        assert!((7..=8).contains(&taken.len()), "then two a second: {taken:?}");
        let due = start + Duration::from_millis(1999) + newest.wait().expect("the last one waits") + Duration::from_millis(1);
        assert_eq!((newest.take_due(due), newest.is_waiting(), newest.wait()), (Some(1999), false, None));
    }
}
