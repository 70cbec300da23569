//! Snapshots become messages: each encoded once and shared by every client that wants it.

use super::track::{Numbering, Pacing, Track};
use crate::snapshot::{PatchCodes, Snapshot, WindFrame};
use bytes::Bytes;
use shared::grid::PatchIndex;
use shared::wire::{self, ServerMessage};
use std::collections::HashMap;

/// Largest change of a patch (codes) that waits for a slow frame. Two codes are 0.05 rad of θ.
pub const DEAD_BAND: u8 = 2;

/// Frames per second of a patch that moves within the dead band (Hz).
pub const SLOW_HZ: f32 = 10.0;

/// Frames per second of the wind (Hz).
pub const WIND_HZ: f32 = 6.0;

/// Time for which the frames of a patch are kept that nobody asks for (s), and half of the longest.
const KEPT_SECS: f32 = 2.0;

/// Encodes what changed since the publish before. Patches that nobody asks for cost nothing.
#[derive(Debug)]
pub struct Encoder {
    publish: u64,
    kept_publishes: u64,
    patch_pacing: Pacing,
    wind_pacing: Pacing,
    patches: HashMap<PatchIndex, Track<PatchCodes>>,
    wind: Option<Track<WindFrame>>,
    /// Messages of this publish about broken plants, by the first and the number past the last in the order of their breaking.
    broken: HashMap<[usize; 2], Bytes>,
    encodings: u64,
}

impl Encoder {
    /// An encoder of a world that is published `publish_hz` times a second.
    pub fn new(publish_hz: f32) -> Self {
        let every = |hz: f32| (publish_hz / hz).round().max(1.0) as u64;
        Self {
            publish: 0,
            kept_publishes: (publish_hz * KEPT_SECS).ceil().max(1.0) as u64,
            patch_pacing: Pacing { dead_band: DEAD_BAND, slow_every: every(SLOW_HZ) },
            wind_pacing: Pacing { dead_band: u8::MAX, slow_every: every(WIND_HZ) },
            patches: HashMap::new(),
            wind: None,
            broken: HashMap::new(),
            encodings: 0,
        }
    }

    /// Starts a publish; every grid may get a new frame. Now and then forgets the patches that nobody has asked for of late.
    pub fn begin(&mut self) {
        self.publish += 1;
        self.broken.clear();
        if self.publish.is_multiple_of(self.kept_publishes) {
            self.patches.retain(|_, track| track.offered_at() + self.kept_publishes >= self.publish);
        }
    }

    /// Grids encoded so far; does not depend on the number of clients.
    pub fn encodings(&self) -> u64 {
        self.encodings
    }

    /// Patches whose frames are kept.
    pub fn tracks(&self) -> usize {
        self.patches.len()
    }

    /// The poses of a snapshot.
    pub fn poses(snapshot: &Snapshot) -> Bytes {
        wire::encode(&ServerMessage::Poses { tick: snapshot.tick, objects: snapshot.objects.clone() }).into()
    }

    /// The message that tells a client of broken plants beyond the first `told`, and how many it then knows of; none if it knows of all.
    pub fn broken(&mut self, snapshot: &Snapshot, told: usize) -> Option<(usize, Bytes)> {
        let news = snapshot.broken.after(told);
        let known = told + news.len();
        let encode = || {
            let mut plants = news.to_vec();
            plants.sort_unstable_by_key(|plant| plant.site);
            wire::encode(&ServerMessage::Broken { plants }).into()
        };
        (!news.is_empty()).then(|| (known, self.broken.entry([told, known]).or_insert_with(encode).clone()))
    }

    /// The message that brings the wind of a client from frame `held` to the newest, and that frame's number.
    pub fn wind(&mut self, snapshot: &Snapshot, held: Option<u32>) -> Option<(u32, Bytes)> {
        let (publish, newest) = (self.publish, Some(&snapshot.wind));
        let track = self.wind.get_or_insert_with(|| Track::new(publish, newest, publish + self.wind_pacing.slow_every));
        track.offer(publish, newest, self.wind_pacing);
        track.message(held, |Numbering { seq, key }, payload| {
            self.encodings += 1;
            wire::encode(&ServerMessage::Wind { tick: snapshot.wind.tick, seq, key, payload }).into()
        })
    }

    /// The message that brings a client's patch from frame `held` to the newest, and that frame's number.
    pub fn patch(&mut self, snapshot: &Snapshot, patch: PatchIndex, held: Option<u32>) -> Option<(u32, Bytes)> {
        let (publish, newest) = (self.publish, snapshot.patches.get(&patch));
        let slow_at = publish + 1 + u64::from(patch) % self.patch_pacing.slow_every;
        let track = self.patches.entry(patch).or_insert_with(|| Track::new(publish, newest, slow_at));
        track.offer(publish, newest, self.patch_pacing);
        track.message(held, |Numbering { seq, key }, payload| {
            self.encodings += 1;
            wire::encode(&ServerMessage::Patch { patch, seq, key, payload }).into()
        })
    }
}
