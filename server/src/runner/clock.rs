//! Fixed-step clock: number of steps due in real time.

use super::recent_drops::RecentDrops;
use std::time::Duration;

/// Largest number of overdue steps done at once; simulated time beyond them is dropped.
pub const CATCH_UP_STEPS: u64 = 6;

/// Counts the fixed steps that are due.
pub(super) struct Clock {
    pub(super) tick_hz: f64,
    /// Steps done or dropped.
    accounted: u64,
    /// Steps dropped.
    pub(super) dropped: u64,
    recent: RecentDrops,
}

impl Clock {
    pub(super) fn new(tick_hz: f64) -> Self {
        Self { tick_hz, accounted: 0, dropped: 0, recent: RecentDrops::default() }
    }

    /// Number of steps to do now, at most [`CATCH_UP_STEPS`]. Steps beyond are dropped.
    pub(super) fn due(&mut self, elapsed: Duration) -> u64 {
        let newly_due = (elapsed.as_secs_f64() * self.tick_hz) as u64 - self.accounted;
        let steps = newly_due.min(CATCH_UP_STEPS);
        self.dropped += newly_due - steps;
        self.recent.note(elapsed, newly_due - steps);
        self.accounted += newly_due;
        steps
    }

    /// Leaves out all steps that are due: simulated time has stood still, none is dropped.
    pub(super) fn skip(&mut self, elapsed: Duration) {
        self.accounted = (elapsed.as_secs_f64() * self.tick_hz) as u64;
    }

    /// Time until `steps` more steps are due.
    pub(super) fn until(&self, steps: u64, elapsed: Duration) -> Duration {
        let next_secs = (self.accounted + steps) as f64 / self.tick_hz;
        Duration::from_secs_f64((next_secs - elapsed.as_secs_f64()).max(0.0))
    }

    /// Simulated time that was dropped (s).
    pub(super) fn dropped_secs(&self) -> f64 {
        self.dropped as f64 / self.tick_hz
    }

    /// Simulated time that was dropped within the last minute (s).
    pub(super) fn dropped_recently_secs(&mut self, elapsed: Duration) -> f64 {
        self.recent.steps(elapsed) as f64 / self.tick_hz
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_on_time_clock_drops_nothing() {
        let mut clock = Clock::new(60.0);
        let steps: u64 = (1..=1000).map(|ms| clock.due(Duration::from_millis(ms * 10))).sum();
        assert_eq!((steps, clock.dropped), (600, 0));
        let wait = clock.until(1, Duration::from_secs(10));
        assert!(wait <= Duration::from_secs_f64(1.0 / 60.0) && wait > Duration::from_millis(16));
        assert_eq!(clock.until(3, Duration::from_millis(10_020)), Duration::from_millis(30));
    }

    #[test]
    fn time_that_stands_still_is_not_dropped() {
        let mut clock = Clock::new(60.0);
        assert_eq!(clock.due(Duration::from_millis(50)), 3);
        clock.skip(Duration::from_secs(100));
        assert_eq!((clock.due(Duration::from_millis(100_050)), clock.dropped), (3, 0));
    }

    #[test]
    fn a_long_pause_is_dropped_not_caught_up() {
        let mut clock = Clock::new(60.0);
        assert_eq!(clock.due(Duration::from_secs(10)), CATCH_UP_STEPS);
        assert_eq!(clock.dropped, 600 - CATCH_UP_STEPS);
        assert_eq!(clock.due(Duration::from_secs(10)), 0);
        assert_eq!(clock.due(Duration::from_secs(11)) + clock.due(Duration::from_secs_f64(11.017)), CATCH_UP_STEPS + 1);
        assert_eq!(clock.dropped_recently_secs(Duration::from_secs(70)), clock.dropped_secs());
        assert_eq!(clock.dropped_recently_secs(Duration::from_secs(72)), 0.0);
    }
}
