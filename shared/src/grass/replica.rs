//! A replica of a server's grass: from a copy of its state, the causes of each step and the wind, it keeps the same bits.

use super::{BendSimulation, BendState, BentPatches, Causes, DecodeError, DecodedStep, EncodedSteps, PatchQuantiser, StepCodec};
use crate::bend::{Serial, StateError};
use crate::grid::PatchIndex;
use crate::wind::WindField;
use crate::wire::{ObjectPose, PatchCheck, TurbulenceState};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use thiserror::Error;

/// Largest state, decompressed (bytes).
pub const STATE_LIMIT_BYTES: usize = 512 << 20;
/// Latest step of a state: a million years at 240 Hz.
const TICK_LIMIT: u64 = 1 << 53;
/// Level of compression of a state: the fastest.
const COMPRESSION_LEVEL: u8 = 1;

/// State of a server's grass after a step, from which a replica starts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReplicaState {
    /// The step.
    pub tick: u64,
    /// The grass.
    pub bend: BendState,
    /// The objects.
    pub codec: StepCodec,
}

/// Reason why a replica cannot be started or continued.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ReplicaError {
    /// The state cannot be decompressed.
    #[error("its state cannot be decompressed to at most {STATE_LIMIT_BYTES} bytes: {0}")]
    Compression(String),
    /// The state cannot be decoded.
    #[error("its state cannot be decoded: {0}")]
    Encoding(#[from] postcard::Error),
    /// The state is that of another scene.
    #[error(transparent)]
    State(#[from] StateError),
    /// The step is out of range.
    #[error("its state is that of step {tick}; allowed: up to {TICK_LIMIT}")]
    Tick {
        /// The step.
        tick: u64,
    },
    /// A step cannot be decoded.
    #[error(transparent)]
    Step(#[from] DecodeError),
}

impl ReplicaState {
    /// The state as compressed bytes.
    ///
    /// # Panics
    /// Never: the state is plain data.
    pub fn encode(&self) -> Vec<u8> {
        let bytes = postcard::to_allocvec(self).expect("the state is plain data");
        miniz_oxide::deflate::compress_to_vec(&bytes, COMPRESSION_LEVEL)
    }

    /// The state from [`encode`](Self::encode).
    ///
    /// # Errors
    /// [`ReplicaError`] when the bytes are not a state, or one of more than [`STATE_LIMIT_BYTES`].
    pub fn decode(bytes: &[u8]) -> Result<Self, ReplicaError> {
        let bytes = miniz_oxide::inflate::decompress_to_vec_with_limit(bytes, STATE_LIMIT_BYTES);
        Ok(postcard::from_bytes(&bytes.map_err(|error| ReplicaError::Compression(error.to_string()))?)?)
    }
}

/// A replica of a server's grass.
pub struct Replica {
    grass: BendSimulation,
    codec: StepCodec,
    wind: WindField,
    /// Tick of the wind frame that `wind` holds.
    wind_tick: Option<u64>,
    quantiser: PatchQuantiser,
    tick: u64,
    dt_secs: f32,
}

impl Replica {
    /// A replica that starts from a copy of the server's state, given the grass at rest, the still air and the step (s) of the same scene.
    ///
    /// # Errors
    /// [`ReplicaError`] when the state is that of another scene.
    pub fn new(mut at_rest: BendSimulation, still_air: WindField, dt_secs: f32, state: ReplicaState) -> Result<Self, ReplicaError> {
        let ReplicaState { tick, bend, codec } = state;
        if tick > TICK_LIMIT {
            return Err(ReplicaError::Tick { tick });
        }
        at_rest.restore(bend)?;
        Ok(Self { grass: at_rest, codec, wind: still_air, wind_tick: None, quantiser: PatchQuantiser::default(), tick, dt_secs })
    }

    /// A copy of the state after the newest step, without the wind.
    pub fn state(&self) -> ReplicaState {
        ReplicaState { tick: self.tick, bend: self.grass.state(), codec: self.codec.clone() }
    }

    /// Number of the newest step.
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// The grass.
    pub fn grass(&self) -> &BendSimulation {
        &self.grass
    }

    /// Tick of the wind frame in use; `None` before the first.
    pub fn wind_tick(&self) -> Option<u64> {
        self.wind_tick
    }

    /// Sets the wind, from the next step on, to that of the frame of `tick`.
    pub fn set_wind(&mut self, tick: u64, codes: &[i16], turbulence: &TurbulenceState) {
        self.wind.set(codes, turbulence);
        self.wind_tick = Some(tick);
    }

    /// Decodes the causes of the next steps, to be done [one by one](Self::advance).
    ///
    /// # Errors
    /// [`ReplicaError`] when they contradict the objects. The replica can then not be continued.
    pub fn decode(&mut self, steps: EncodedSteps) -> Result<Vec<DecodedStep>, ReplicaError> {
        Ok(self.codec.decode(steps, self.dt_secs)?)
    }

    /// Does the next step, in which nothing changes.
    pub fn rest(&mut self) {
        let causes = self.codec.quiet(self.dt_secs);
        self.advance(causes);
    }

    /// Does the next step, by its causes.
    pub fn advance(&mut self, causes: Causes) {
        self.grass.follow(self.dt_secs, causes, &self.wind, &Serial);
        self.tick += 1;
    }

    /// The first patch whose grass differs from the server's after the newest step.
    pub fn first_difference(&self, checks: &[PatchCheck]) -> Option<PatchIndex> {
        checks.iter().find(|check| self.grass.patch_checksum(check.patch) != check.sum).map(|check| check.patch)
    }

    /// Poses of all objects after the newest step, ascending by number.
    pub fn objects(&self) -> impl Iterator<Item = ObjectPose> {
        self.codec.objects(self.dt_secs)
    }

    /// Codes of all patches that are not at rest.
    pub fn codes(&mut self) -> Arc<BentPatches> {
        self.quantiser.quantise(self.tick, &self.grass, |_| true, &Serial)
    }
}

impl std::fmt::Debug for Replica {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Replica").field("tick", &self.tick).finish_non_exhaustive()
    }
}
