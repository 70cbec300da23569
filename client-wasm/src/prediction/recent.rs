//! The median of the newest measurements.

use std::collections::VecDeque;

/// Number of measurements.
const COUNT: usize = 8;

/// The newest measurements.
#[derive(Clone, Debug, Default)]
pub(super) struct Recent(VecDeque<f64>);

impl Recent {
    pub(super) fn add(&mut self, value: f64) {
        if self.0.len() == COUNT {
            self.0.pop_front();
        }
        self.0.push_back(value);
    }

    /// Their median; `None` before the first.
    pub(super) fn median(&self) -> Option<f64> {
        let mut sorted: Vec<f64> = self.0.iter().copied().collect();
        sorted.sort_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied()
    }
}
