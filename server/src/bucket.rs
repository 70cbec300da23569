//! A token bucket: a mean rate with room for bursts.

use std::time::Instant;

/// Fills at a constant rate up to its capacity; what is taken must be there.
#[derive(Clone, Copy, Debug)]
pub struct Bucket {
    capacity: f64,
    per_sec: f64,
    level: f64,
    filled_at: Instant,
}

impl Bucket {
    /// A full bucket that holds `capacity` and gains `per_sec` a second.
    pub fn new(capacity: f64, per_sec: f64, now: Instant) -> Self {
        Self { capacity, per_sec, level: capacity, filled_at: now }
    }

    /// Adds what has flowed in until `now`.
    pub fn fill(&mut self, now: Instant) {
        let elapsed_secs = now.saturating_duration_since(self.filled_at).as_secs_f64();
        self.level = (self.level + elapsed_secs * self.per_sec).min(self.capacity);
        self.filled_at = now;
    }

    /// Takes `amount` if that much is there.
    pub fn try_take(&mut self, amount: f64) -> bool {
        let enough = self.level >= amount;
        if enough {
            self.level -= amount;
        }
        enough
    }

    /// Takes `amount` even if it leaves a debt, provided that there is no debt yet. Over any time the sum taken exceeds what flowed in
    /// by at most the capacity and one amount.
    pub fn try_overdraw(&mut self, amount: f64) -> bool {
        let solvent = self.level > 0.0;
        if solvent {
            self.level -= amount;
        }
        solvent
    }

    /// Takes `amount` whatever is there.
    pub fn charge(&mut self, amount: f64) {
        self.level -= amount;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn the_mean_rate_holds_after_the_burst() {
        let start = Instant::now();
        let mut bucket = Bucket::new(10.0, 5.0, start);
        let mut taken = 0;
        for milliseconds in 0..10_000 {
            bucket.fill(start + Duration::from_millis(milliseconds));
            taken += u32::from(bucket.try_take(1.0));
        }
        assert!((58..=60).contains(&taken), "burst of 10 and 5 a second for 10 s, got {taken}");
    }

    #[test]
    fn an_overdraft_is_paid_back() {
        let start = Instant::now();
        let mut bucket = Bucket::new(1.0, 1.0, start);
        assert!(bucket.try_overdraw(100.0));
        bucket.fill(start + Duration::from_secs(99));
        assert!(!bucket.try_overdraw(1.0));
        bucket.fill(start + Duration::from_secs(100));
        assert!(bucket.try_overdraw(1.0));
    }
}
