//! Load of a world: the mean time of a tick over some time, since the wind's steps, estimates of errors and copies for the journal come in single ticks.

use std::collections::VecDeque;
use std::time::Duration;

/// Time over which an overload is measured, and at most.
const SHORT: Duration = Duration::from_millis(400);
const LONG: Duration = Duration::from_secs(2);

/// Times of the newest ticks.
#[derive(Debug, Default)]
pub(super) struct Load {
    /// Time of the end, number, and time altogether (ms) of the ticks before each publication, oldest first.
    ticks: VecDeque<(Duration, u32, f64)>,
    /// Since when there are ticks.
    since: Option<Duration>,
    last_mean_ms: f32,
}

impl Load {
    /// Notes `ticks` that took `busy_ms` each, and ended `now` (time since the start).
    pub(super) fn note(&mut self, now: Duration, ticks: u32, busy_ms: f64) {
        if self.since.is_none() {
            // How long the first ones took in real time is not known.
            self.since = Some(now);
            if self.last_mean_ms == 0.0 {
                self.last_mean_ms = busy_ms as f32;
            }
            return;
        }
        self.ticks.push_back((now, ticks, busy_ms * f64::from(ticks)));
        while self.ticks.front().is_some_and(|(end, ..)| now.saturating_sub(*end) > LONG) {
            self.ticks.pop_front();
        }
        if let Some(mean_ms) = self.mean_ms(now) {
            self.last_mean_ms = mean_ms;
        }
    }

    /// Forgets all ticks, so that the effect of a change is measured alone.
    pub(super) fn clear(&mut self) {
        self.ticks.clear();
        self.since = None;
    }

    /// Mean time of a tick (ms) of at least the last 0.4 s and at most the last two seconds; `None` before.
    pub(super) fn mean_ms(&self, now: Duration) -> Option<f32> {
        self.mean_since(now, SHORT)
    }

    /// Mean time of a tick (ms) of the last two seconds; `None` before.
    pub(super) fn long_mean_ms(&self, now: Duration) -> Option<f32> {
        self.mean_since(now, LONG)
    }

    /// The newest mean that was known (ms).
    pub(super) fn last_mean_ms(&self) -> f32 {
        self.last_mean_ms
    }

    fn mean_since(&self, now: Duration, least: Duration) -> Option<f32> {
        if now.saturating_sub(self.since?) < least {
            return None;
        }
        let (ticks, busy_ms) = self.ticks.iter().fold((0, 0.0), |(ticks, ms), (_, more, busy_ms)| (ticks + more, ms + busy_ms));
        (ticks > 0).then(|| (busy_ms / f64::from(ticks)) as f32)
    }
}
