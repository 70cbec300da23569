//! Clients whose connection was lost, and for how long their vehicles are kept.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Time for which the vehicle of a lost connection is kept (s of simulated time).
pub const KEPT_SECS: f32 = 60.0;

/// Lost clients with a vehicle, by number, with the tick in which they left.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Departed(BTreeMap<u32, u64>);

impl Departed {
    pub(super) fn leave(&mut self, client: u32, tick: u64) {
        self.0.insert(client, tick);
    }

    pub(super) fn forget(&mut self, client: u32) {
        self.0.remove(&client);
    }

    /// Removes and returns the client that left first.
    pub(super) fn pop_longest(&mut self) -> Option<u32> {
        let longest = self.0.iter().min_by_key(|(_, left)| **left).map(|(client, _)| *client)?;
        self.0.remove(&longest);
        Some(longest)
    }

    pub(super) fn clients(&self) -> Vec<u32> {
        self.0.keys().copied().collect()
    }

    /// Removes and returns the clients whose time is over at `tick`, with steps of `dt_secs`.
    pub(super) fn expired(&mut self, tick: u64, dt_secs: f32) -> Vec<u32> {
        let kept_ticks = (KEPT_SECS / dt_secs).round() as u64;
        let is_over = |left: &u64| tick.saturating_sub(*left) >= kept_ticks;
        let over = self.0.iter().filter(|(_, left)| is_over(left)).map(|(client, _)| *client).collect();
        self.0.retain(|_, left| !is_over(left));
        over
    }
}
