//! A record of the last minutes: the messages that a mirror has applied, and checkpoints between them.

use super::checkpoint::Checkpoint;
use super::error::MirrorError;
use super::mirror::{Event, Mirror};
use prairie_core::wire::{self, ServerMessage};
use std::collections::VecDeque;

/// Time recorded (s). Until the next checkpoint falls out, the record is up to [`CHECKPOINT_SECS`] longer.
pub const RECORD_SECS: f64 = 120.0;
/// Largest memory of a record (bytes). A record that would exceed it becomes shorter.
pub const RECORD_LIMIT_BYTES: usize = 64 << 20;
/// Time between two checkpoints (s).
pub const CHECKPOINT_SECS: f64 = 5.0;

/// A frame of the record.
#[derive(Debug)]
pub(super) struct RecordedFrame {
    /// Time of playback (s).
    pub(super) secs: f64,
    /// Its messages as sent, the end of the frame included.
    pub(super) messages: Vec<Vec<u8>>,
    /// Whether it does not go on from the frame before: there was another replica or none then, or frames are missing.
    pub(super) is_start: bool,
    /// State after the frame. A start has one.
    pub(super) checkpoint: Option<Checkpoint>,
}

impl RecordedFrame {
    fn memory_bytes(&self) -> usize {
        let messages = self.messages.iter().map(|message| size_of::<Vec<u8>>() + message.len()).sum::<usize>();
        size_of::<Self>() + messages + self.checkpoint.as_ref().map_or(0, Checkpoint::memory_bytes)
    }
}

/// Frames of the last minutes, begun with a checkpoint. Of a time without a replica, it has the patches that the server has sent.
#[derive(Debug)]
pub struct Record {
    frames: VecDeque<RecordedFrame>,
    /// Number of the first frame, counted from the first that was ever recorded.
    first: u64,
    /// Messages of the frame that has not ended yet.
    begun: Vec<Vec<u8>>,
    /// Whether they say more than where the objects are.
    has_news: bool,
    /// Whether the next frame is a start.
    is_interrupted: bool,
    /// Time before which no checkpoint is tried, since the last one was too large (s).
    too_large_until_secs: f64,
    checkpoint_secs: f64,
    memory_bytes: usize,
    limit_bytes: usize,
}

impl Default for Record {
    fn default() -> Self {
        Self::with_limit(RECORD_LIMIT_BYTES)
    }
}

impl Record {
    /// An empty record that takes at most `limit_bytes` of memory.
    pub fn with_limit(limit_bytes: usize) -> Self {
        let (frames, begun) = (VecDeque::new(), Vec::new());
        Self {
            frames,
            first: 0,
            begun,
            has_news: false,
            is_interrupted: true,
            too_large_until_secs: f64::NEG_INFINITY,
            checkpoint_secs: 0.0,
            memory_bytes: 0,
            limit_bytes,
        }
    }

    /// Applies a message to the mirror, and records it.
    ///
    /// # Errors
    /// As [`Mirror::apply`].
    pub fn apply(&mut self, mirror: &mut Mirror, message: ServerMessage) -> Result<Option<Event>, MirrorError> {
        let is_recorded = matches!(
            message,
            ServerMessage::Poses { .. }
                | ServerMessage::Wind { .. }
                | ServerMessage::Patch { .. }
                | ServerMessage::Steps { .. }
                | ServerMessage::Broken { .. }
                | ServerMessage::FrameEnd { .. }
        );
        let starts_replica = matches!(message, ServerMessage::ReplicaState { part, parts, .. } if part.checked_add(1) == Some(parts));
        self.has_news |= is_recorded && !matches!(message, ServerMessage::Poses { .. } | ServerMessage::FrameEnd { .. });
        let had_replica = mirror.replica().is_some();
        let bytes = is_recorded.then(|| wire::encode(&message));
        let event = mirror.apply(message)?;
        self.begun.extend(bytes);
        let is_interrupted = starts_replica || mirror.replica().is_some() != had_replica;
        if is_interrupted || self.begun.iter().map(Vec::len).sum::<usize>() > self.limit_bytes {
            self.begun.clear();
            self.is_interrupted = true;
        }
        match event {
            Some(Event::Scene) => self.clear(),
            Some(Event::FrameEnd { .. }) => self.end_frame(mirror),
            _ => {}
        }
        Ok(event)
    }

    /// Adds the frame that has ended, with a checkpoint if one is due.
    fn end_frame(&mut self, mirror: &Mirror) {
        let (mut messages, secs) = (std::mem::take(&mut self.begun), mirror.secs_of(mirror.tick()));
        let has_news = std::mem::take(&mut self.has_news);
        // An earlier step is that of a world that was restarted; the same step comes again from a replay that stands still.
        match self.newest_secs() {
            Some(newest_secs) if secs < newest_secs => self.clear(),
            Some(newest_secs) if secs == newest_secs && !has_news && !self.is_interrupted => return,
            _ => {}
        }
        let is_start = self.is_interrupted || self.frames.is_empty();
        let is_due = is_start || secs - self.checkpoint_secs >= CHECKPOINT_SECS;
        let may_try = is_due && secs >= self.too_large_until_secs;
        let checkpoint = may_try.then(|| mirror.checkpoint(self.limit_bytes)).flatten();
        if checkpoint.is_some() {
            (self.checkpoint_secs, self.is_interrupted) = (secs, false);
        } else if may_try {
            self.too_large_until_secs = secs + CHECKPOINT_SECS;
        }
        if checkpoint.is_some() || !is_start {
            if is_start {
                // The checkpoint holds what they say.
                messages.clear();
            }
            let frame = RecordedFrame { secs, messages, is_start, checkpoint };
            self.memory_bytes += frame.memory_bytes();
            self.frames.push_back(frame);
        }
        self.trim(secs);
    }

    /// Drops the oldest frames, up to a checkpoint, while the record reaches too far back from `newest_secs`, or is too large.
    fn trim(&mut self, newest_secs: f64) {
        let next = |record: &Self| record.frames.iter().skip(1).position(|frame| frame.checkpoint.is_some()).map(|place| place + 1);
        while let Some(front) = self.frames.front() {
            let is_too_large = self.memory_bytes > self.limit_bytes;
            if !is_too_large && newest_secs - front.secs < RECORD_SECS {
                break;
            }
            match next(self) {
                Some(place) if is_too_large || newest_secs - self.frames[place].secs >= RECORD_SECS => self.drop_first(place),
                None if is_too_large || newest_secs - self.frames[self.frames.len() - 1].secs >= RECORD_SECS => self.clear(),
                _ => break,
            }
        }
    }

    fn drop_first(&mut self, count: usize) {
        self.memory_bytes -= self.frames.drain(..count).map(|frame| frame.memory_bytes()).sum::<usize>();
        self.first += count as u64;
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.drop_first(self.frames.len());
        self.begun.clear();
        (self.is_interrupted, self.too_large_until_secs) = (true, f64::NEG_INFINITY);
    }

    /// Memory of the record (bytes).
    pub fn memory_bytes(&self) -> usize {
        self.memory_bytes
    }

    /// Time of playback of the oldest moment (s); `None` while nothing is recorded.
    pub fn oldest_secs(&self) -> Option<f64> {
        Some(self.frames.front()?.secs)
    }

    /// Time of playback of the newest moment (s).
    pub fn newest_secs(&self) -> Option<f64> {
        Some(self.frames.back()?.secs)
    }

    /// Time recorded (s).
    pub fn length_secs(&self) -> f64 {
        self.oldest_secs().zip(self.newest_secs()).map_or(0.0, |(oldest_secs, newest_secs)| newest_secs - oldest_secs)
    }

    /// The frame of this number, if it is still recorded.
    pub(super) fn frame(&self, number: u64) -> Option<&RecordedFrame> {
        self.frames.get(usize::try_from(number.checked_sub(self.first)?).ok()?)
    }

    /// Number of the first frame recorded.
    pub(super) fn first(&self) -> u64 {
        self.first
    }

    /// The newest checkpoint at or before `secs`, or else the oldest, and the number of its frame.
    pub(super) fn checkpoint_before(&self, secs: f64) -> Option<(u64, &Checkpoint)> {
        let end = self.frames.partition_point(|frame| frame.secs <= secs).max(1).min(self.frames.len());
        let (place, checkpoint) =
            (0..end).rev().find_map(|place| self.frames[place].checkpoint.as_ref().map(|checkpoint| (place, checkpoint)))?;
        Some((self.first + place as u64, checkpoint))
    }
}
