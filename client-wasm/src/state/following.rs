//! The replica of the server's grass: assembled from the parts of its state, then advanced by the causes of each step.

use super::error::{MirrorError, range};
use super::fields::{PatchFields, WindFrames};
use super::scene::DecodedScene;
use prairie_core::grass::{BentPatches, DecodedStep, EncodedSteps, Replica, ReplicaState};
use prairie_core::grid::PatchIndex;
use prairie_core::wire::ObjectPose;
use std::sync::Arc;

/// Largest number of parts of a state, and largest part (bytes).
const PARTS_LIMIT: u16 = 2048;
const PART_LIMIT_BYTES: usize = 64 << 10;
/// Largest number of steps that a message may skip because nothing changes in them.
const QUIET_LIMIT: u64 = 10_000;

/// A part of a state.
pub(super) struct Part {
    pub(super) tick: u64,
    pub(super) part: u16,
    pub(super) parts: u16,
    pub(super) payload: Vec<u8>,
}

/// The replica, and the state on its way.
#[derive(Debug, Default)]
pub(super) struct Following {
    tick: u64,
    /// Parts received so far, in order.
    received: Vec<u8>,
    next_part: u16,
    replica: Option<Replica>,
    /// Codes of the replica as they were shown last.
    shown: Arc<BentPatches>,
    /// Tick after which the replica was found to differ, and a patch.
    differs: Option<(u64, PatchIndex)>,
}

impl Following {
    /// Takes in a part of a state; the last one starts the replica. Parts out of order are dropped.
    pub(super) fn receive(&mut self, part: Part, decoded: &DecodedScene) -> Result<(), MirrorError> {
        let Part { tick, part, parts, payload } = part;
        if parts > PARTS_LIMIT || part >= parts || payload.len() > PART_LIMIT_BYTES {
            let allowed = format!("below the number of parts, which is at most {PARTS_LIMIT}, of at most {PART_LIMIT_BYTES} bytes");
            return Err(range("part of a replica's state", format!("{part} of {parts}, {} bytes", payload.len()), allowed));
        }
        if part == 0 {
            (self.tick, self.next_part) = (tick, 0);
            self.received.clear();
        }
        if tick != self.tick || part != self.next_part {
            return Ok(());
        }
        self.received.extend(payload);
        self.next_part += 1;
        if self.next_part == parts {
            let state = ReplicaState::decode(&std::mem::take(&mut self.received)).map_err(MirrorError::Replica)?;
            self.replica = Some(decoded.replica(state).map_err(MirrorError::Replica)?);
            self.shown = Arc::default();
        }
        Ok(())
    }

    /// Goes on from a replica, of which nothing is shown yet.
    pub(super) fn of(replica: Replica) -> Self {
        Self { replica: Some(replica), ..Self::default() }
    }

    /// Ends the replica: patches follow.
    pub(super) fn stop(&mut self) {
        self.replica = None;
    }

    /// The replica, if there is one.
    pub(super) fn replica(&self) -> Option<&Replica> {
        self.replica.as_ref()
    }

    /// Tick after which the replica was found to differ since the last call, and a patch that differs.
    pub(super) fn take_difference(&mut self) -> Option<(u64, PatchIndex)> {
        self.differs.take()
    }

    /// Does all steps up to the last of `steps`. Without a replica, and when they are part of its state, they are dropped.
    pub(super) fn advance(&mut self, steps: EncodedSteps, wind: &WindFrames) -> Result<(), MirrorError> {
        if self.replica.as_ref().is_none_or(|replica| steps.first_tick <= replica.tick()) {
            return Ok(());
        }
        self.rest_until(steps.first_tick - 1, wind)?;
        let Some(replica) = &mut self.replica else { return Ok(()) };
        for DecodedStep { tick, causes, checks } in replica.decode(steps).map_err(MirrorError::Replica)? {
            set_wind(replica, wind);
            replica.advance(causes);
            if let Some(patch) = replica.first_difference(&checks) {
                self.differs = Some((tick, patch));
                self.replica = None;
                break;
            }
        }
        Ok(())
    }

    /// Does all steps up to `tick`, in which nothing changes.
    pub(super) fn rest_until(&mut self, tick: u64, wind: &WindFrames) -> Result<(), MirrorError> {
        let Some(replica) = &mut self.replica else { return Ok(()) };
        let quiet = tick.saturating_sub(replica.tick());
        if quiet > QUIET_LIMIT {
            return Err(range("number of steps without a change", quiet, format!("at most {QUIET_LIMIT}")));
        }
        for _ in 0..quiet {
            set_wind(replica, wind);
            replica.rest();
        }
        Ok(())
    }

    /// Poses of all objects of the replica, if there is one.
    pub(super) fn objects(&self) -> Option<Vec<ObjectPose>> {
        Some(self.replica.as_ref()?.objects().collect())
    }

    /// Shows the replica: its codes become those of `patches`.
    pub(super) fn show(&mut self, patches: &mut PatchFields) {
        let Some(replica) = &mut self.replica else { return };
        let codes = replica.codes();
        for index in patches.bent().filter(|index| !codes.contains_key(index)).collect::<Vec<_>>() {
            patches.set(index, None);
        }
        for (index, newest) in codes.iter() {
            if !self.shown.get(index).is_some_and(|shown| Arc::ptr_eq(shown, newest)) {
                patches.set(*index, Some(&newest.codes));
            }
        }
        self.shown = codes;
    }
}

/// Sets the wind of the replica's next step.
fn set_wind(replica: &mut Replica, wind: &WindFrames) {
    if let Some(frame) = wind.frame_of(replica.tick() + 1).filter(|frame| replica.wind_tick() != Some(frame.tick())) {
        replica.set_wind(frame.tick(), frame.codes(), frame.turbulence());
    }
}
