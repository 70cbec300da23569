//! Inputs that were sent, and are not in a pose of the server yet.

use prairie_core::wire::Drive;
use std::collections::VecDeque;

/// Largest number of inputs on their way: more than two seconds of them. Beyond it the oldest count as applied.
const LIMIT: usize = 64;

/// An input on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SentInput {
    number: u32,
    drive: Drive,
    /// State shown by a frame that arrived by the fastest way when it was sent (steps).
    pub(super) fresh_ticks: f64,
    /// First step in which it is expected to have effect.
    tick: u64,
}

/// The inputs on their way, oldest first.
#[derive(Debug, Default)]
pub(super) struct SentInputs {
    /// Number of the newest input.
    number: u32,
    applied: Drive,
    pending: VecDeque<SentInput>,
}

impl SentInputs {
    /// Adds an input that is expected to have effect from step `tick` on; returns its number.
    pub(super) fn send(&mut self, drive: Drive, fresh_ticks: f64, tick: u64) -> u32 {
        self.number = self.number.checked_add(1).unwrap_or(1);
        let tick = self.pending.back().map_or(tick, |last| tick.max(last.tick));
        if self.pending.len() == LIMIT {
            self.applied = self.pending.pop_front().map_or(self.applied, |oldest| oldest.drive);
        }
        self.pending.push_back(SentInput { number: self.number, drive, fresh_ticks, tick });
        self.number
    }

    /// Removes an input that is in the newest pose of the server, and those before it. Any other number changes nothing.
    pub(super) fn acknowledge(&mut self, number: u32) -> Option<SentInput> {
        let place = self.pending.iter().position(|input| input.number == number)?;
        let input = self.pending.drain(..=place).next_back()?;
        self.applied = input.drive;
        Some(input)
    }

    /// Forgets all inputs; numbers go on.
    pub(super) fn clear(&mut self) {
        self.pending.clear();
        self.applied = Drive::default();
    }

    /// The input in step `tick`, which is after the newest pose of the server.
    pub(super) fn drive_in(&self, tick: u64) -> Drive {
        self.pending.iter().rev().find(|input| input.tick <= tick).map_or(self.applied, |input| input.drive)
    }

    /// First step in which the newest input is expected to have effect; 0 without one.
    pub(super) fn newest_tick(&self) -> u64 {
        self.pending.back().map_or(0, |input| input.tick)
    }

    /// First step in which an input on its way is expected to have effect.
    pub(super) fn first_tick(&self) -> Option<u64> {
        self.pending.front().map(|input| input.tick)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn throttle(throttle: f32) -> Drive {
        Drive { throttle, ..Drive::default() }
    }

    #[test]
    fn inputs_have_effect_in_order_until_they_are_applied() {
        let mut inputs = SentInputs::default();
        assert_eq!(
            [inputs.send(throttle(0.1), 0.0, 10), inputs.send(throttle(0.2), 3.0, 13), inputs.send(throttle(0.3), 2.0, 12)],
            [1, 2, 3]
        );
        assert_eq!([9, 10, 12, 13, 99].map(|tick| inputs.drive_in(tick).throttle), [0.0, 0.1, 0.1, 0.3, 0.3]);
        assert_eq!(inputs.acknowledge(9), None, "never sent");
        assert_eq!(inputs.acknowledge(2).map(|input| input.fresh_ticks), Some(3.0));
        assert_eq!(inputs.acknowledge(1), None, "applied before");
        assert_eq!([5, 99].map(|tick| inputs.drive_in(tick).throttle), [0.2, 0.3]);
        inputs.clear();
        assert_eq!((inputs.drive_in(99), inputs.first_tick()), (Drive::default(), None));
        assert_eq!(inputs.send(throttle(1.0), 0.0, 1), 4, "numbers go on");
    }

    #[test]
    fn numbers_wrap_and_skip_that_of_no_input_and_memory_is_bounded() {
        let mut inputs = SentInputs { number: u32::MAX - 1, ..SentInputs::default() };
        assert_eq!([inputs.send(throttle(0.1), 0.0, 1), inputs.send(throttle(0.2), 0.0, 2)], [u32::MAX, 1]);
        for tick in 0..1000 {
            inputs.send(throttle(0.5), 0.0, tick);
        }
        assert_eq!(inputs.pending.len(), LIMIT);
        assert_eq!(inputs.drive_in(0), throttle(0.5));
    }
}
