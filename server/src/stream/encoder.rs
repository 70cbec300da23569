//! Snapshots become messages: each encoded once and shared by every client that wants it.

use super::track::{Numbering, Pacing, Track};
use crate::snapshot::{PatchCodes, Snapshot, WindFrame};
use bytes::Bytes;
use shared::grid::PatchIndex;
use shared::wire::{self, ServerMessage};
use std::collections::HashMap;

/// Largest change of a patch (codes) that waits for a slow frame. Two codes are 0.025 rad of θ.
pub const DEAD_BAND: u8 = 2;

/// Frames per second of a patch that moves within the dead band (Hz).
pub const SLOW_HZ: f32 = 10.0;

/// Frames per second of the wind (Hz).
pub const WIND_HZ: f32 = 6.0;

/// Encodes what changed since the publish before. Patches that nobody asks for cost nothing.
#[derive(Debug)]
pub struct Encoder {
    publish: u64,
    patch_pacing: Pacing,
    wind_pacing: Pacing,
    patches: HashMap<PatchIndex, Track<PatchCodes>>,
    wind: Track<WindFrame>,
    encodings: u64,
}

impl Encoder {
    /// An encoder of a world that is published `publish_hz` times a second.
    pub fn new(publish_hz: f32) -> Self {
        let every = |hz: f32| (publish_hz / hz).round().max(1.0) as u64;
        Self {
            publish: 0,
            patch_pacing: Pacing { dead_band: DEAD_BAND, slow_every: every(SLOW_HZ) },
            wind_pacing: Pacing { dead_band: u8::MAX, slow_every: every(WIND_HZ) },
            patches: HashMap::new(),
            wind: Track::new(0),
            encodings: 0,
        }
    }

    /// Starts a publish; every grid may get a new frame.
    pub fn begin(&mut self) {
        self.publish += 1;
    }

    /// Grids encoded so far; does not depend on the number of clients.
    pub fn encodings(&self) -> u64 {
        self.encodings
    }

    /// The poses of a snapshot.
    pub fn poses(snapshot: &Snapshot) -> Bytes {
        wire::encode(&ServerMessage::Poses { tick: snapshot.tick, objects: snapshot.objects.clone() }).into()
    }

    /// The message that brings the wind of a client from frame `held` to the newest, and that frame's number.
    pub fn wind(&mut self, snapshot: &Snapshot, held: u32) -> Option<(u32, Bytes)> {
        self.wind.offer(self.publish, Some(&snapshot.wind), self.wind_pacing);
        self.wind.message(held, |Numbering { seq, key }, payload| {
            self.encodings += 1;
            wire::encode(&ServerMessage::Wind { tick: snapshot.wind.tick, seq, key, payload }).into()
        })
    }

    /// The message that brings a client's patch from frame `held` to the newest, and that frame's number.
    pub fn patch(&mut self, snapshot: &Snapshot, patch: PatchIndex, held: u32) -> Option<(u32, Bytes)> {
        let newest = snapshot.patches.get(patch as usize)?.as_ref();
        let slow_at = self.publish + u64::from(patch) % self.patch_pacing.slow_every;
        let track = self.patches.entry(patch).or_insert_with(|| Track::new(slow_at));
        track.offer(self.publish, newest, self.patch_pacing);
        track.message(held, |Numbering { seq, key }, payload| {
            self.encodings += 1;
            wire::encode(&ServerMessage::Patch { patch, seq, key, payload }).into()
        })
    }
}
