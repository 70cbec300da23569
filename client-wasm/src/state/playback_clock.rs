//! Clock of playback: how far the picture is behind the newest state, from the lateness of the snapshots.

use std::collections::VecDeque;

/// Delay before anything is measured (s).
const INITIAL_DELAY_SECS: f64 = 0.1;
/// Longest delay (s), unless the interval between snapshots is longer.
const LONGEST_DELAY_SECS: f64 = 0.4;
/// Part of the delay for what cannot be measured (s), such as the time from the arrival of a snapshot to the next picture.
const MARGIN_SECS: f64 = 0.005;
/// Time over which the lateness is measured (s), and largest number of snapshots in it.
const WINDOW_SECS: f64 = 4.0;
const ARRIVAL_LIMIT: usize = 256;
/// Fraction of the snapshots that may come later than the delay allows.
const TOO_LATE: f64 = 0.02;
/// Interval between snapshots (s) beyond which it was a pause, in which nothing happened or nothing came.
const PAUSE_SECS: f64 = 0.3;
/// Largest deviation of the clock's rate from that of real time.
const SLEW: f64 = 0.05;
/// Change of the lateness (s) that is not jitter but another clock: then playback jumps. A later one must last for [`LATER_ARRIVALS`].
const JUMP_SECS: f64 = 0.5;
const LATER_ARRIVALS: usize = 10;
/// Number of snapshots up to which playback may still jump forward: the first ones often wait while the client loads the scene.
const FIRST_ARRIVALS: usize = 20;

/// Arrival of a snapshot.
#[derive(Clone, Copy, Debug)]
struct Arrival {
    clock_secs: f64,
    /// The client's clock at the arrival minus the snapshot's simulated time (s).
    late_secs: f64,
    /// Simulated time since the snapshot before (s), unless it was a pause.
    interval_secs: Option<f64>,
}

/// The clock of playback.
///
/// Its delay behind the fastest snapshots is the interval between snapshots, plus the jitter of all but [`TOO_LATE`] of the last [`WINDOW_SECS`], plus [`MARGIN_SECS`]: a next
/// snapshot to move towards is then there. It follows a changed delay by running up to [`SLEW`] faster or slower.
#[derive(Debug)]
pub(super) struct PlaybackClock {
    clock_secs: f64,
    arrivals: VecDeque<Arrival>,
    /// Lateness of the fastest snapshot in the window (s).
    fastest_secs: f64,
    interval_secs: f64,
    delay_secs: f64,
    /// The client's clock minus the time of playback (s); `None` before the first snapshot.
    behind_secs: Option<f64>,
}

impl Default for PlaybackClock {
    fn default() -> Self {
        Self {
            clock_secs: 0.0,
            arrivals: VecDeque::new(),
            fastest_secs: 0.0,
            interval_secs: 0.0,
            delay_secs: INITIAL_DELAY_SECS,
            behind_secs: None,
        }
    }
}

impl PlaybackClock {
    /// Advances the client's clock by `dt_secs`.
    pub(super) fn advance(&mut self, dt_secs: f64) {
        self.clock_secs += dt_secs;
        if let Some(behind_secs) = &mut self.behind_secs {
            let slew_secs = SLEW * dt_secs.max(0.0);
            *behind_secs += (self.fastest_secs + self.delay_secs - *behind_secs).clamp(-slew_secs, slew_secs);
        }
    }

    /// Measures the arrival of the snapshot of `time_secs`, `interval_secs` after the one before.
    pub(super) fn receive(&mut self, time_secs: f64, interval_secs: Option<f64>) {
        let late_secs = self.clock_secs - time_secs;
        let is_earlier = late_secs < self.fastest_secs - JUMP_SECS;
        if is_earlier || self.is_later_for_good(late_secs) {
            self.restart();
        }
        while self.arrivals.front().is_some_and(|first| self.clock_secs - first.clock_secs > WINDOW_SECS)
            || self.arrivals.len() >= ARRIVAL_LIMIT
        {
            self.arrivals.pop_front();
        }
        let interval_secs = interval_secs.filter(|secs| (0.0..PAUSE_SECS).contains(secs));
        self.arrivals.push_back(Arrival { clock_secs: self.clock_secs, late_secs, interval_secs });
        self.measure();
        let wanted_secs = self.fastest_secs + self.delay_secs;
        match self.behind_secs {
            Some(behind_secs) if behind_secs <= wanted_secs || self.arrivals.len() > FIRST_ARRIVALS => {}
            _ => self.behind_secs = Some(wanted_secs),
        }
    }

    /// Whether this snapshot and those before it are later than the older ones by [`JUMP_SECS`].
    fn is_later_for_good(&self, late_secs: f64) -> bool {
        let is_later = |late_secs: f64| late_secs > self.fastest_secs + JUMP_SECS;
        let newest = self.arrivals.iter().rev().take(LATER_ARRIVALS);
        is_later(late_secs) && self.arrivals.len() > LATER_ARRIVALS && newest.into_iter().all(|arrival| is_later(arrival.late_secs))
    }

    fn measure(&mut self) {
        let mut late: Vec<f64> = self.arrivals.iter().map(|arrival| arrival.late_secs).collect();
        late.sort_by(f64::total_cmp);
        let mut intervals: Vec<f64> = self.arrivals.iter().filter_map(|arrival| arrival.interval_secs).collect();
        intervals.sort_by(f64::total_cmp);
        let in_time = ((1.0 - TOO_LATE) * (late.len() - 1) as f64).round() as usize;
        self.fastest_secs = late[0];
        if let Some(median_secs) = intervals.get(intervals.len() / 2) {
            self.interval_secs = *median_secs;
            let delay_secs = self.interval_secs + (late[in_time] - late[0]) + MARGIN_SECS;
            self.delay_secs = delay_secs.min(LONGEST_DELAY_SECS.max(self.interval_secs + MARGIN_SECS));
        }
    }

    /// Forgets all arrivals: with the next snapshot, playback jumps.
    pub(super) fn restart(&mut self) {
        self.arrivals.clear();
        (self.behind_secs, self.delay_secs) = (None, INITIAL_DELAY_SECS);
    }

    /// Sets the time of playback to `time_secs`, to which nothing is late.
    pub(super) fn show_at(&mut self, time_secs: f64) {
        *self = Self { clock_secs: time_secs, delay_secs: 0.0, behind_secs: Some(0.0), ..Self::default() };
    }

    /// Simulated time of playback (s); `None` before the first snapshot.
    pub(super) fn time_secs(&self) -> Option<f64> {
        Some(self.clock_secs - self.behind_secs?)
    }

    /// The client's clock (s).
    #[cfg(test)]
    pub(super) fn now_secs(&self) -> f64 {
        self.clock_secs
    }

    /// Simulated time of a snapshot that would arrive now by the fastest way (s); `None` before the first snapshot.
    pub(super) fn fresh_secs(&self) -> Option<f64> {
        self.behind_secs.map(|_| self.clock_secs - self.fastest_secs)
    }

    /// Time by which playback is behind the fastest snapshots (s), when it has followed all changes.
    pub(super) fn delay_secs(&self) -> f64 {
        self.delay_secs
    }
}
