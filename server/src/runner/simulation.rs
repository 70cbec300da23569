//! What the runner steps.

use crate::detail::DetailRange;
use crate::journal::Health;
use crate::snapshot::{PatchQuantiser, Snapshot};
use crate::world::{Command, World};
use prairie_core::grass::BendState;
use prairie_core::wire::ObjectId;
use std::sync::Arc;

/// Interface of a simulation to the runner: the world, or a stand-in for tests.
pub trait Simulation: Send + 'static {
    /// Advances by one fixed step after carrying out `commands` in order.
    fn step(&mut self, commands: &[Command]);
    /// The state after the newest step. `quantiser` is the same at every call.
    fn publish(&self, quantiser: &mut PatchQuantiser) -> Snapshot;
    /// A copy of the state of the grass after the newest step, from which replicas start; `None` if they cannot follow it.
    fn bend_state(&self) -> Option<BendState> {
        None
    }
    /// The object that a client drives.
    fn object_of(&self, client: u32) -> Option<ObjectId>;
    /// Whether nothing but the wind moves. The runner then does all steps up to the next snapshot at once, which wakes the processor less often.
    fn is_idle(&self) -> bool {
        false
    }
    /// Whether nothing but the wind would change if the world paused.
    fn is_at_rest(&self) -> bool {
        false
    }
    /// Number of steps before the first one.
    fn tick(&self) -> u64 {
        0
    }
    /// Key for the proofs of clients, which stays the same over restarts; `None` for one that does not.
    fn key(&self) -> Option<[u8; 32]> {
        None
    }
    /// Clients that have left and whose vehicles are kept for their return.
    fn departed(&self) -> Vec<u32> {
        Vec::new()
    }
    /// Lowest client number that was never used.
    fn first_client(&self) -> u32 {
        1
    }
    /// Estimates the errors of the world's steps from now on.
    fn watch_errors(&mut self) {}
    /// What the detail can be adapted to; `None` if it cannot.
    fn detail_range(&self) -> Option<DetailRange> {
        None
    }
    /// State of the journal's files, for the metrics; `None` without memory.
    fn journal_health(&self) -> Option<Arc<Health>> {
        None
    }
}

impl Simulation for World {
    fn departed(&self) -> Vec<u32> {
        Self::departed(self)
    }

    fn tick(&self) -> u64 {
        Self::tick(self)
    }

    fn step(&mut self, commands: &[Command]) {
        Self::step(self, commands);
    }

    fn publish(&self, quantiser: &mut PatchQuantiser) -> Snapshot {
        Self::publish(self, quantiser)
    }

    fn bend_state(&self) -> Option<BendState> {
        Self::bend_state(self)
    }

    fn object_of(&self, client: u32) -> Option<ObjectId> {
        Self::object_of(self, client)
    }

    fn is_idle(&self) -> bool {
        Self::is_idle(self)
    }

    fn is_at_rest(&self) -> bool {
        Self::is_at_rest(self)
    }

    fn watch_errors(&mut self) {
        Self::watch_errors(self);
    }

    fn detail_range(&self) -> Option<DetailRange> {
        Some(Self::detail_range(self))
    }
}
