//! A token bucket: a mean rate with room for bursts.

use std::time::{Duration, Instant};

/// A token bucket: it fills at a constant rate up to its capacity.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TokenBucket {
    capacity: f64,
    rate_per_s: f64,
    level: f64,
    filled_at: Instant,
}

impl TokenBucket {
    /// A full bucket of `capacity` tokens that gains `rate_per_s`.
    pub(crate) fn new(capacity: f64, rate_per_s: f64, now: Instant) -> Self {
        Self { capacity, rate_per_s, level: capacity, filled_at: now }
    }

    /// Adds the tokens gained until `now`.
    pub(crate) fn fill(&mut self, now: Instant) {
        let elapsed_secs = now.saturating_duration_since(self.filled_at).as_secs_f64();
        self.level = (self.level + elapsed_secs * self.rate_per_s).min(self.capacity);
        self.filled_at = now;
    }

    /// Takes `amount` if the bucket holds that much.
    pub(crate) fn try_take(&mut self, amount: f64) -> bool {
        let enough = self.level >= amount;
        if enough {
            self.level -= amount;
        }
        enough
    }

    /// Takes `amount` if the bucket is not in debt, even if that leaves a debt. Over any period the sum taken exceeds the tokens gained by
    /// at most the capacity plus one amount.
    pub(crate) fn try_overdraw(&mut self, amount: f64) -> bool {
        let solvent = self.is_solvent();
        if solvent {
            self.level -= amount;
        }
        solvent
    }

    /// Whether the bucket is not in debt.
    pub(crate) fn is_solvent(&self) -> bool {
        self.level > 0.0
    }

    /// Time from the last filling until the bucket holds `amount`; [`Duration::MAX`] if it never will.
    pub(crate) fn wait(&self, amount: f64) -> Duration {
        Duration::try_from_secs_f64((amount - self.level).max(0.0) / self.rate_per_s).unwrap_or(Duration::MAX)
    }

    /// Takes `amount` unconditionally.
    pub(crate) fn charge(&mut self, amount: f64) {
        self.level -= amount;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_burst_is_followed_by_the_mean_rate() {
        let start = Instant::now();
        let mut bucket = TokenBucket::new(10.0, 5.0, start);
        let mut taken = 0;
        for ms in 0..10_000 {
            bucket.fill(start + Duration::from_millis(ms));
            taken += u32::from(bucket.try_take(1.0));
        }
        assert!((58..=60).contains(&taken), "burst of 10 and 5 a second for 10 s, got {taken}");
    }

    #[test]
    fn a_debt_is_paid_back_before_the_next_take() {
        let start = Instant::now();
        let mut bucket = TokenBucket::new(1.0, 1.0, start);
        assert!(bucket.try_overdraw(100.0));
        bucket.fill(start + Duration::from_secs(99));
        assert!(!bucket.try_overdraw(1.0));
        bucket.fill(start + Duration::from_secs(100));
        assert!(bucket.try_overdraw(1.0));
    }

    #[test]
    fn the_wait_ends_when_the_bucket_holds_the_amount() {
        let start = Instant::now();
        let mut bucket = TokenBucket::new(8.0, 2.0, start);
        assert_eq!(bucket.wait(8.0), Duration::ZERO);
        bucket.charge(8.0);
        assert_eq!(bucket.wait(3.0), Duration::from_millis(1500));
        assert_eq!(TokenBucket::new(0.0, 0.0, start).wait(1.0), Duration::MAX);
    }
}
