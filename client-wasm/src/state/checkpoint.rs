//! Checkpoints of the mirror, from which a second mirror of the same scene goes on.

use super::broken_plants::BrokenPlants;
use super::error::MirrorError;
use super::fields::WindFrames;
use super::following::Following;
use super::mirror::{Mirror, WIND_DELAY_SECS};
use prairie_core::grass::ReplicaState;
use std::sync::Arc;

/// State of a mirror with a replica after a frame.
#[derive(Debug)]
pub(super) struct Checkpoint {
    tick: u64,
    time_secs: f64,
    /// State of the replica, encoded.
    replica: Vec<u8>,
    /// Wind frames from the one shown on; the last one is the base of the next delta.
    wind: WindFrames,
    broken: BrokenPlants,
}

impl Checkpoint {
    /// Memory (bytes).
    pub(super) fn memory_bytes(&self) -> usize {
        self.replica.len() + self.wind.memory_bytes() + self.broken.falls().len()
    }
}

impl Mirror {
    /// State after the newest frame; `None` without a replica.
    pub(super) fn checkpoint(&self) -> Option<Checkpoint> {
        let replica = self.replica().filter(|replica| replica.tick() == self.tick)?;
        let delay_ticks = (WIND_DELAY_SECS * f64::from(self.tick_hz())).ceil() as u64;
        Some(Checkpoint {
            tick: self.tick,
            time_secs: self.time_secs,
            replica: replica.state().encode(),
            wind: self.wind.since(self.tick.saturating_sub(delay_ticks)),
            broken: self.broken.clone(),
        })
    }

    /// A second mirror of the same scene and peers that goes on from a checkpoint. Its patches are not shown yet.
    ///
    /// # Errors
    /// [`MirrorError`] when the checkpoint is that of another scene.
    pub(super) fn at(&self, checkpoint: &Checkpoint) -> Result<Self, MirrorError> {
        let decoded = self.scene.as_ref().ok_or(MirrorError::BeforeScene("checkpoint"))?;
        let state = ReplicaState::decode(&checkpoint.replica).map_err(MirrorError::Replica)?;
        let replica = decoded.replica(state).map_err(MirrorError::Replica)?;
        let mut wind_field = decoded.still_air();
        if let Some(newest) = checkpoint.wind.newest() {
            wind_field.set(newest.codes(), newest.turbulence());
        }
        let mut past = Self {
            scene: Some(Arc::clone(decoded)),
            scene_number: self.scene_number,
            following: Following::of(replica),
            wind: checkpoint.wind.clone(),
            wind_field: Some(wind_field),
            broken: checkpoint.broken.clone(),
            peers: self.peers.clone(),
            ..Self::default()
        };
        past.end_frame(checkpoint.tick, checkpoint.time_secs)?;
        Ok(past)
    }
}
