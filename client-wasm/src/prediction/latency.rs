//! Latency: times from an input to its effects.

use super::recent::Recent;
use prairie_core::wire::AppliedInput;
use std::collections::VecDeque;

/// Largest number of inputs that wait for their effects, and longest wait (s). Those beyond are not measured.
const WAITING_LIMIT: usize = 32;
const WAITING_SECS: f64 = 3.0;

/// An input that waits for its effects.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    number: u32,
    /// Time of the event that caused it (s).
    event_secs: f64,
    /// First step in which it is expected to have effect.
    expected_tick: u64,
    /// First step in which the server says that it has effect.
    applied_tick: Option<u64>,
    is_pictured: bool,
}

impl Waiting {
    /// Whether a picture of a moment (steps) shows its effect. A predicted picture is of `predicted`, another one of `interpolated`.
    fn is_shown(&self, predicted: Option<f64>, interpolated: f64) -> bool {
        // Between two steps, the vehicle already moves by the input of the later one.
        let is_at = |ticks: f64, tick: u64| ticks > tick as f64 - 1.0;
        match predicted {
            Some(ticks) => is_at(ticks, self.applied_tick.unwrap_or(self.expected_tick)),
            None => self.applied_tick.is_some_and(|tick| is_at(interpolated, tick)),
        }
    }
}

/// Measured latencies.
#[derive(Debug, Default)]
pub struct Latency {
    waiting: VecDeque<Waiting>,
    to_picture: Recent,
    to_server: Recent,
}

impl Latency {
    /// Time from an input's event to the end of drawing the first picture that shows its effect (s): the median of the last eight. The way to the screen is not included.
    pub fn to_picture_secs(&self) -> Option<f64> {
        self.to_picture.median()
    }

    /// Time from an input's event to the arrival of the first pose of the server with its effect (s): the median of the last eight.
    pub fn to_server_secs(&self) -> Option<f64> {
        self.to_server.median()
    }

    pub(super) fn send(&mut self, number: u32, event_secs: f64, expected_tick: u64) {
        if self.waiting.len() == WAITING_LIMIT {
            self.waiting.pop_front();
        }
        self.waiting.push_back(Waiting { number, event_secs, expected_tick, applied_tick: None, is_pictured: false });
    }

    /// Notes a frame, at `now_secs`, in whose poses an input has effect. Those before it never had any effect if they are not known to be applied.
    pub(super) fn acknowledge(&mut self, applied: AppliedInput, now_secs: f64) {
        let Some(place) = self.waiting.iter().position(|input| input.number == applied.number) else { return };
        self.waiting[place].applied_tick = Some(applied.tick);
        self.to_server.add(now_secs - self.waiting[place].event_secs);
        let is_superseded = |input: &Waiting| input.applied_tick.is_none() && (applied.number.wrapping_sub(input.number) as i32) > 0;
        self.waiting.retain(|input| !is_superseded(input));
        self.forget(now_secs);
    }

    /// Notes a picture that was drawn at `now_secs`: of the moment `predicted` (steps), or else `interpolated`.
    pub(super) fn draw(&mut self, predicted: Option<f64>, interpolated: f64, now_secs: f64) {
        for input in self.waiting.iter_mut().filter(|input| !input.is_pictured && input.is_shown(predicted, interpolated)) {
            input.is_pictured = true;
            self.to_picture.add(now_secs - input.event_secs);
        }
        self.forget(now_secs);
    }

    /// Forgets all inputs that wait.
    pub(super) fn clear(&mut self) {
        self.waiting.clear();
    }

    fn forget(&mut self, now_secs: f64) {
        let waits = |input: &Waiting| !(input.is_pictured && input.applied_tick.is_some()) && now_secs - input.event_secs < WAITING_SECS;
        self.waiting.retain(waits);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_prediction_shows_an_input_at_once_and_the_server_confirms_it_later() {
        let mut latency = Latency::default();
        latency.send(1, 10.0, 607);
        latency.draw(Some(606.4), 590.0, 10.012);
        assert!((latency.to_picture_secs().expect("shown") - 0.012).abs() < 1e-9 && latency.to_server_secs().is_none());
        latency.draw(Some(607.4), 591.0, 10.029);
        latency.acknowledge(AppliedInput { number: 1, tick: 607 }, 10.13);
        assert!((latency.to_server_secs().expect("applied") - 0.13).abs() < 1e-9);
        assert!(latency.waiting.is_empty());
    }

    #[test]
    fn without_a_prediction_a_picture_shows_an_input_when_playback_reaches_its_step() {
        let mut latency = Latency::default();
        latency.send(1, 10.0, 607);
        latency.draw(None, 650.0, 10.01);
        assert_eq!(latency.to_picture_secs(), None, "the server may not have it");
        latency.acknowledge(AppliedInput { number: 1, tick: 609 }, 10.1);
        latency.draw(None, 608.0, 10.15);
        assert_eq!(latency.to_picture_secs(), None);
        latency.draw(None, 608.5, 10.17);
        assert!((latency.to_picture_secs().expect("shown") - 0.17).abs() < 1e-9);
    }

    #[test]
    fn inputs_without_effect_are_not_measured() {
        let mut latency = Latency::default();
        for number in 1..=100 {
            latency.send(number, 10.0, 607);
        }
        assert_eq!(latency.waiting.len(), WAITING_LIMIT);
        latency.acknowledge(AppliedInput { number: 7, tick: 600 }, 10.1);
        assert_eq!(latency.to_server_secs(), None, "forgotten");
        latency.acknowledge(AppliedInput { number: 99, tick: 600 }, 10.1);
        assert_eq!(latency.waiting.iter().map(|input| input.number).collect::<Vec<_>>(), [99, 100], "the others were replaced");
        latency.draw(None, 0.0, 13.1);
        assert!(latency.waiting.is_empty() && latency.to_picture_secs().is_none());
    }
}
