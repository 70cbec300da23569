//! Steps dropped within the last minute.

use std::collections::VecDeque;
use std::time::Duration;

/// Age beyond which dropped steps are forgotten.
pub const RECENT: Duration = Duration::from_secs(60);

/// Shortest time between two entries, so that there are at most 61 of them.
const ENTRY: Duration = Duration::from_secs(1);

/// The steps dropped within [`RECENT`], to the second.
#[derive(Default)]
pub(super) struct RecentDrops {
    /// Time since the start when an entry began, and steps dropped since then, oldest first.
    entries: VecDeque<(Duration, u64)>,
}

impl RecentDrops {
    /// Notes that `steps` are dropped at `elapsed` since the start.
    pub(super) fn note(&mut self, elapsed: Duration, steps: u64) {
        self.forget(elapsed);
        match self.entries.back_mut() {
            _ if steps == 0 => {}
            Some((begun, sum)) if elapsed < *begun + ENTRY => *sum += steps,
            _ => self.entries.push_back((elapsed, steps)),
        }
    }

    /// Steps dropped within the minute before `elapsed`.
    pub(super) fn steps(&mut self, elapsed: Duration) -> u64 {
        self.forget(elapsed);
        self.entries.iter().map(|(_, steps)| steps).sum()
    }

    fn forget(&mut self, elapsed: Duration) {
        while self.entries.front().is_some_and(|(begun, _)| *begun + RECENT < elapsed) {
            self.entries.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drops_are_forgotten_after_a_minute() {
        let mut drops = RecentDrops::default();
        let ms = Duration::from_millis;
        drops.note(ms(1_000), 3);
        drops.note(ms(30_000), 4);
        assert_eq!([1_000, 60_000, 61_000, 61_001, 90_000, 90_001].map(|at| drops.steps(ms(at))), [7, 7, 7, 4, 4, 0]);
    }

    #[test]
    fn constant_drops_need_little_memory() {
        let mut drops = RecentDrops::default();
        for ms in 0..200_000 {
            drops.note(Duration::from_millis(ms), 1);
        }
        assert!(drops.entries.len() <= 61, "{} entries", drops.entries.len());
        assert!((60_000..61_000).contains(&drops.steps(Duration::from_secs(200))), "{}", drops.steps(Duration::from_secs(200)));
    }
}
