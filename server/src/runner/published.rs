//! What the runner publishes.

use super::controller::ControlReport;
use crate::histogram::Histogram;
use crate::snapshot::Snapshot;
use prairie_core::grass::BendState;
use prairie_core::wire::ObjectId;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

/// Bounds of the histogram of step durations (s).
const STEP_BOUNDS_SECS: [f64; 12] = [0.0005, 0.001, 0.002, 0.004, 0.008, 0.016, 0.032, 0.064, 0.125, 0.25, 0.5, 1.0];

/// An empty histogram of step durations.
pub(super) fn step_histogram() -> Histogram {
    Histogram::new(&STEP_BOUNDS_SECS)
}

/// The newest state, with information from the runner.
#[derive(Clone, Debug)]
pub struct Published {
    /// The world's state.
    pub snapshot: Snapshot,
    /// Outcome of each client's newest request for a vehicle.
    pub requests: BTreeMap<u32, Request>,
    /// Clients that have left and whose vehicles are kept for their return.
    pub departed: Vec<u32>,
    /// Simulated time that was dropped because the machine is too slow (s).
    pub dropped_secs: f64,
    /// The part of it that was dropped within the last minute, [`RECENT`](super::RECENT) (s).
    pub dropped_recently_secs: f64,
    /// Durations of all steps so far (s), wall-clock time.
    pub step_secs: Histogram,
    /// State of the grass, if it was [requested](super::Runner::state_request).
    pub bend_state: Option<Arc<BendState>>,
    /// Whether the world is paused, because nobody is there and only the wind would change.
    pub is_paused: bool,
    /// State of the controller of the detail; `None` where the detail stays as it is.
    pub control: Option<ControlReport>,
    /// Time of the publication.
    pub at: Instant,
}

impl Published {
    /// A state without requests and losses, published now.
    pub fn new(snapshot: Snapshot) -> Self {
        Self {
            snapshot,
            requests: BTreeMap::new(),
            departed: Vec::new(),
            dropped_secs: 0.0,
            dropped_recently_secs: 0.0,
            step_secs: step_histogram(),
            bend_state: None,
            is_paused: false,
            control: None,
            at: Instant::now(),
        }
    }
}

impl Published {
    /// Whether a client has a vehicle, connected or not.
    pub fn has_vehicle(&self, client: u32) -> bool {
        self.departed.contains(&client) || self.requests.get(&client).is_some_and(|request| request.object.is_some())
    }
}

/// A client's request for a vehicle, granted or refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Request {
    /// Step that decided it.
    pub tick: u64,
    /// The object, or `None` when the request was refused.
    pub object: Option<ObjectId>,
}
