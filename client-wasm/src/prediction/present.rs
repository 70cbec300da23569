//! The present of the prediction: the step of the world in which an input that is sent now has effect.

use super::recent::Recent;

/// Round-trip time (s) until the first ping is back.
const ROUND_TRIP_SECS: f64 = 0.1;
/// Largest deviation of the clock's rate from that of real time.
const SLEW: f64 = 0.05;
/// Deviation (s) at which the clock is set at once.
const JUMP_SECS: f64 = 0.25;

/// The present, in steps of the world, with fractions.
///
/// A frame that arrives now shows a state that is as old as its way; an input that is sent now has effect in a later step still. The distance of the two, the lead, is measured
/// by the inputs that are known to be applied; before the first, it is the round-trip time of a ping.
#[derive(Debug, Default)]
pub(super) struct Present {
    ticks: Option<f64>,
    now_secs: f64,
    leads: Recent,
    round_trip_secs: Option<f64>,
}

impl Present {
    /// Notes the round-trip time of a ping (s).
    pub(super) fn note_round_trip(&mut self, secs: f64) {
        self.round_trip_secs = Some(secs);
    }

    /// Notes that an input has effect from step `tick` on; a frame that arrived when it was sent would have shown the state at `fresh_ticks`.
    pub(super) fn note_applied(&mut self, tick: u64, fresh_ticks: f64) {
        // It came between two steps: on average in the middle.
        self.leads.add(tick as f64 - 0.5 - fresh_ticks);
    }

    /// Distance of the present from the newest frame by the fastest way (steps).
    pub(super) fn lead_ticks(&self, tick_hz: f64) -> f64 {
        let estimated = self.round_trip_secs.unwrap_or(ROUND_TRIP_SECS) * tick_hz;
        self.leads.median().unwrap_or(estimated).max(0.0)
    }

    /// Goes on to `now_secs`. `fresh_ticks`: state shown by a frame that would arrive now by the fastest way.
    pub(super) fn advance(&mut self, now_secs: f64, tick_hz: f64, fresh_ticks: f64) {
        let passed_ticks = (now_secs - self.now_secs).max(0.0) * tick_hz;
        self.now_secs = now_secs;
        let goal = fresh_ticks + self.lead_ticks(tick_hz);
        let moved_on = self.ticks.map(|ticks| ticks + passed_ticks);
        self.ticks = Some(match moved_on {
            Some(ticks) if (goal - ticks).abs() < JUMP_SECS * tick_hz => {
                ticks + (goal - ticks).clamp(-SLEW * passed_ticks, SLEW * passed_ticks)
            }
            _ => goal,
        });
    }

    /// The present (steps); `None` before the first frame.
    pub(super) fn ticks(&self) -> Option<f64> {
        self.ticks
    }

    /// The first step in which an input that is sent now is expected to have effect.
    pub(super) fn next_tick(&self) -> u64 {
        self.ticks.map_or(0, |ticks| ticks.max(0.0).ceil() as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_present_is_where_inputs_have_effect_and_moves_there_smoothly() {
        let mut present = Present::default();
        present.note_round_trip(0.1);
        present.advance(10.0, 60.0, 600.0);
        assert_eq!(present.ticks(), Some(606.0));
        // Inputs take 0.15 s instead.
        (0..9).for_each(|_| present.note_applied(1010, 1000.5));
        let mut before = 606.0;
        for n in 1..=200 {
            let secs = f64::from(n) / 60.0;
            present.advance(10.0 + secs, 60.0, 600.0 + 60.0 * secs);
            let ticks = present.ticks().expect("there was a frame");
            assert!((ticks - before - 1.0).abs() < 0.051, "{before} to {ticks}");
            before = ticks;
        }
        assert!((before - (800.0 + 9.0)).abs() < 1e-6, "{before}");
        // A world that was set back.
        present.advance(20.0, 60.0, 100.0);
        assert_eq!(present.ticks(), Some(109.0));
    }
}
