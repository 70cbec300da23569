//! Checkpoints of the mirror, from which a second mirror of the same scene goes on.

use super::broken_plants::BrokenPlants;
use super::error::MirrorError;
use super::fields::{PatchFields, WindFrames};
use super::following::Following;
use super::mirror::{Mirror, WIND_DELAY_SECS};
use prairie_core::grass::{RepeatedPatch, ReplicaState};
use prairie_core::wire::ObjectPose;
use std::sync::Arc;

/// The grass and the objects of a checkpoint.
#[derive(Debug)]
enum Grass {
    /// State of the replica, encoded.
    Replica(Vec<u8>),
    /// Without a replica: what the server has sent.
    Sent {
        patches: PatchFields,
        objects: Vec<ObjectPose>,
        /// Time of playback of the objects (s).
        objects_secs: f64,
    },
}

/// State of a mirror after a frame.
#[derive(Debug)]
pub(super) struct Checkpoint {
    tick: u64,
    time_secs: f64,
    grass: Grass,
    /// Wind frames from the one shown on; the last one is the base of the next delta.
    wind: WindFrames,
    broken: BrokenPlants,
}

impl Checkpoint {
    /// Memory (bytes).
    pub(super) fn memory_bytes(&self) -> usize {
        let grass_bytes = match &self.grass {
            Grass::Replica(state) => state.len(),
            Grass::Sent { patches, objects, .. } => patches.memory_bytes() + size_of_val(objects.as_slice()),
        };
        grass_bytes + self.wind.memory_bytes() + self.broken.falls().len()
    }
}

impl Mirror {
    /// State after the newest frame; `None` before the scene, while a replica is not at the step of this frame, and if it takes more than `limit_bytes` of memory.
    pub(super) fn checkpoint(&self, limit_bytes: usize) -> Option<Checkpoint> {
        self.scene.as_ref()?;
        let grass = match self.replica() {
            Some(replica) if replica.tick() == self.tick => Grass::Replica(replica.state().encode()),
            Some(_) => return None,
            None if self.patches.memory_bytes() > limit_bytes => return None,
            None => Grass::Sent {
                patches: self.patches.clone(),
                objects: self.poses.newest().to_vec(),
                objects_secs: self.poses.newest_secs().unwrap_or_else(|| self.secs_of(self.tick)),
            },
        };
        let delay_ticks = (WIND_DELAY_SECS * f64::from(self.tick_hz())).ceil() as u64;
        let checkpoint = Checkpoint {
            tick: self.tick,
            time_secs: self.time_secs,
            grass,
            wind: self.wind.since(self.tick.saturating_sub(delay_ticks)),
            broken: self.broken.clone(),
        };
        Some(checkpoint).filter(|checkpoint| checkpoint.memory_bytes() <= limit_bytes)
    }

    /// A second mirror of the same scene and peers that goes on from a checkpoint. The patches of a replica are not shown yet.
    ///
    /// # Errors
    /// [`MirrorError`] when the checkpoint is that of another scene.
    pub(super) fn at(&self, checkpoint: &Checkpoint) -> Result<Self, MirrorError> {
        let decoded = self.scene.as_ref().ok_or(MirrorError::BeforeScene("checkpoint"))?;
        let mut wind_field = decoded.still_air();
        if let Some(newest) = checkpoint.wind.newest() {
            wind_field.set(newest.codes(), newest.turbulence());
        }
        let mut past = Self {
            scene: Some(Arc::clone(decoded)),
            scene_number: self.scene_number,
            wind: checkpoint.wind.clone(),
            wind_field: Some(wind_field),
            broken: checkpoint.broken.clone(),
            peers: self.peers.clone(),
            repeated: RepeatedPatch::new(decoded.scene()),
            ..Self::default()
        };
        match &checkpoint.grass {
            Grass::Replica(state) => {
                let state = ReplicaState::decode(state).map_err(MirrorError::Replica)?;
                past.following = Following::of(decoded.replica(state).map_err(MirrorError::Replica)?);
            }
            Grass::Sent { patches, objects, objects_secs } => {
                past.patches.clone_from(patches);
                past.patches.touch();
                past.poses.push(*objects_secs, objects.clone())?;
            }
        }
        past.end_frame(checkpoint.tick, checkpoint.time_secs)?;
        Ok(past)
    }
}
