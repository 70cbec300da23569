//! The newest steps of the grass, encoded once for all clients that have a replica of it, and states from which replicas start.

use bytes::Bytes;
use prairie_core::grass::{BendState, EncodedSteps, ReplicaState, StepCodec, StepRecord};
use prairie_core::wire::{self, ServerMessage};
use std::collections::VecDeque;
use std::sync::Arc;

/// Time for which publications with changes are kept for clients that lag (s).
const KEPT_SECS: f32 = 40.0;
/// Longest transfer of a state at the whole data rate of a client (s); the steps since must still be kept after it.
const TRANSFER_SECS: f64 = 32.0;
/// Size of the parts of a state (bytes).
const PART_BYTES: usize = 16 << 10;
/// Largest encoded state that is sent at any data rate (bytes); larger worlds are sent as patches.
const STATE_LIMIT_BYTES: usize = 8 << 20;

/// The steps of one publication in which something changes, with the wind frame that is released in them.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    /// The wind message of this publication, and the number of its frame.
    pub(super) wind: Option<(u32, Bytes)>,
    /// The steps message; `None` if only the wind changes.
    pub(super) steps: Option<Bytes>,
}

/// An encoded state of the grass.
#[derive(Debug)]
pub(super) struct EncodedState {
    /// Messages of its parts.
    pub(super) parts: Vec<Bytes>,
    /// Key frame of the wind after the step, and its number.
    pub(super) wind: Option<(u32, Bytes)>,
    /// Number of the first entry after it.
    pub(super) next_entry: u64,
}

/// The newest steps.
#[derive(Debug)]
pub struct StepLog {
    /// Largest number of entries.
    entries_limit: usize,
    /// Largest encoded state that is sent (bytes).
    state_limit_bytes: usize,
    codec: StepCodec,
    /// The newest step, and the tick of its wind.
    newest: Option<(u64, u64)>,
    entries: VecDeque<Entry>,
    /// Number of the first entry.
    first: u64,
    state: Option<Arc<EncodedState>>,
    /// Whether the newest state that was asked for was too large to be sent.
    is_too_large: bool,
}

impl StepLog {
    /// An empty log of a world that is published `publish_hz` times per second to clients with a data rate of `bytes_per_s`.
    pub(super) fn new(publish_hz: f32, bytes_per_s: f64) -> Self {
        Self {
            entries_limit: (publish_hz * KEPT_SECS).ceil().max(1.0) as usize,
            state_limit_bytes: STATE_LIMIT_BYTES.min((bytes_per_s * TRANSFER_SECS) as usize),
            codec: StepCodec::default(),
            newest: None,
            entries: VecDeque::new(),
            first: 0,
            state: None,
            is_too_large: false,
        }
    }

    /// Adds the steps up to a publication, of those that are new, and the wind message of this publication. When a step or a wind frame is missing, as after a
    /// long pause of this thread, all replicas must start again.
    pub(super) fn extend(&mut self, records: &[Arc<StepRecord>], wind_tick: u64, wind: Option<(u32, Bytes)>) {
        self.state = None;
        let after = self.newest.map_or(0, |(tick, _)| tick);
        let new: Vec<_> = records.iter().filter(|record| record.tick > after).collect();
        let is_next = new.first().is_none_or(|record| self.newest.is_some() && record.tick == after + 1);
        let known_wind = self.newest.map_or(0, |(_, tick)| tick);
        let has_winds = new.iter().all(|record| record.wind_tick == known_wind || record.wind_tick == wind_tick);
        if !(is_next && has_winds) {
            // No client's next entry is ever this one.
            self.first += self.entries.len() as u64 + 1;
            self.entries.clear();
        }
        if let Some(record) = new.last() {
            self.newest = Some((record.tick, wind_tick));
        }
        let steps = self.codec.encode(new.into_iter().map(|record| &**record));
        let steps = steps.map(|EncodedSteps { first_tick, heads, moves }| {
            wire::encode(&ServerMessage::Steps { first_tick, steps: heads, moves }).into()
        });
        if steps.is_some() || wind.is_some() {
            self.entries.push_back(Entry { wind, steps });
        }
        if self.entries.len() > self.entries_limit {
            self.entries.pop_front();
            self.first += 1;
        }
    }

    /// Encodes a state of the grass after the newest step, for replicas that start, with the key frame of the wind of this publication.
    pub(super) fn set_state(&mut self, bend: &BendState, wind: Option<(u32, Bytes)>) {
        let Some((tick, _)) = self.newest else { return };
        let state = ReplicaState { tick, bend: bend.clone(), codec: self.codec.clone() }.encode();
        if state.len() > self.state_limit_bytes {
            // Said once, although a state is asked for again and again.
            if !std::mem::replace(&mut self.is_too_large, true) {
                tracing::warn!(
                    bytes = state.len(),
                    limit = self.state_limit_bytes,
                    "the grass is too large for replicas; new clients get patches"
                );
            }
            return;
        }
        self.is_too_large = false;
        let chunks = state.chunks(PART_BYTES);
        let parts = chunks.len() as u16;
        let message = |(part, payload): (usize, &[u8])| {
            wire::encode(&ServerMessage::ReplicaState { tick, part: part as u16, parts, payload: payload.to_vec() }).into()
        };
        let parts = chunks.enumerate().map(message).collect();
        self.state = Some(Arc::new(EncodedState { parts, wind, next_entry: self.next_entry() }));
    }

    /// The state after the newest step, if it was [set](Self::set_state).
    pub(super) fn state(&self) -> Option<&Arc<EncodedState>> {
        self.state.as_ref()
    }

    /// Number of the entry after the newest.
    pub(super) fn next_entry(&self) -> u64 {
        self.first + self.entries.len() as u64
    }

    /// The entries from a number on; `None` when some of them are gone.
    pub(super) fn since(&self, entry: u64) -> Option<impl Iterator<Item = &Entry>> {
        let skipped = entry.checked_sub(self.first)? as usize;
        (skipped <= self.entries.len()).then(|| self.entries.iter().skip(skipped))
    }
}
