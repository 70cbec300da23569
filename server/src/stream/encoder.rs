//! Encoding of snapshots as messages, each encoded once and shared by all clients.

use super::grid_frames::{FrameHeader, GridFrames};
use crate::snapshot::{PatchCodes, Snapshot, WindFrame};
use bytes::Bytes;
use prairie_core::grid::PatchIndex;
use prairie_core::wire::{self, ServerMessage};
use std::collections::HashMap;

/// Shortest time before the frames of a patch outside every area of interest are dropped (s); the longest is twice this.
const CACHE_SECS: f32 = 2.0;

/// Encoder of the changes since the previous publication. Patches that no client requests cost nothing.
#[derive(Debug)]
pub struct Encoder {
    publish: u64,
    cache_publishes: u64,
    patches: HashMap<PatchIndex, GridFrames<PatchCodes>>,
    wind: Option<GridFrames<WindFrame>>,
    /// Messages of this publication about broken plants, by their range in the order of breaking: first, past the last.
    broken: HashMap<[usize; 2], Bytes>,
    encodings: u64,
}

impl Encoder {
    /// An encoder for a world that is published `publish_hz` times per second.
    pub fn new(publish_hz: f32) -> Self {
        Self {
            publish: 0,
            cache_publishes: (publish_hz * CACHE_SECS).ceil().max(1.0) as u64,
            patches: HashMap::new(),
            wind: None,
            broken: HashMap::new(),
            encodings: 0,
        }
    }

    /// Starts a publication, in which every grid may get a new frame. Periodically drops the patches that no client has requested lately.
    pub fn begin(&mut self) {
        self.publish += 1;
        self.broken.clear();
        if self.publish.is_multiple_of(self.cache_publishes) {
            self.patches.retain(|_, frames| frames.offered_at() + self.cache_publishes >= self.publish);
        }
    }

    /// Number of grids encoded so far; independent of the number of clients.
    pub fn encodings(&self) -> u64 {
        self.encodings
    }

    /// Number of patches whose frames are cached.
    pub fn cached_patches(&self) -> usize {
        self.patches.len()
    }

    /// The poses message of a snapshot.
    pub fn poses(snapshot: &Snapshot) -> Bytes {
        wire::encode(&ServerMessage::Poses { tick: snapshot.tick, objects: snapshot.objects.clone() }).into()
    }

    /// The message about the broken plants after the first `known`, and the number then known; `None` if there are no more.
    pub fn broken(&mut self, snapshot: &Snapshot, known: usize) -> Option<(usize, Bytes)> {
        let newer = snapshot.broken.after(known);
        let count = known + newer.len();
        let encode = || {
            let mut plants = newer.to_vec();
            plants.sort_unstable_by_key(|plant| plant.site);
            wire::encode(&ServerMessage::Broken { plants }).into()
        };
        (!newer.is_empty()).then(|| (count, self.broken.entry([known, count]).or_insert_with(encode).clone()))
    }

    /// The message from the wind frame before to the newest one, and the number of that; `None` if this publication brings none.
    pub fn next_wind(&mut self, snapshot: &Snapshot) -> Option<(u32, Bytes)> {
        let before = self.wind.as_ref().map(GridFrames::seq);
        let next = self.wind(snapshot, before);
        // The first frame of all is not a change.
        before.and(next)
    }

    /// The message that updates a client's wind from frame `held` to the newest one, and the number of that frame.
    pub fn wind(&mut self, snapshot: &Snapshot, held: Option<u32>) -> Option<(u32, Bytes)> {
        let (publish, newest) = (self.publish, Some(&snapshot.wind));
        let frames = self.wind.get_or_insert_with(|| GridFrames::new(publish, newest));
        frames.offer(publish, newest);
        let (tick, turbulence) = frames.newest().map(|wind| (wind.tick, wind.turbulence)).unwrap_or_default();
        frames.message(held, |FrameHeader { seq, key }, payload| {
            self.encodings += 1;
            wire::encode(&ServerMessage::Wind { tick, seq, key, turbulence, payload }).into()
        })
    }

    /// The message that updates a client's patch from frame `held` to the newest one, and the number of that frame.
    pub fn patch(&mut self, snapshot: &Snapshot, patch: PatchIndex, held: Option<u32>) -> Option<(u32, Bytes)> {
        let (publish, newest) = (self.publish, snapshot.patches.get(&patch));
        let frames = self.patches.entry(patch).or_insert_with(|| GridFrames::new(publish, newest));
        frames.offer(publish, newest);
        frames.message(held, |FrameHeader { seq, key }, payload| {
            self.encodings += 1;
            wire::encode(&ServerMessage::Patch { patch, seq, key, payload }).into()
        })
    }
}
