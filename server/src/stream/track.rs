//! One streamed grid: its numbered frames, each encoded at most once, whoever wants it.

use crate::snapshot::{PatchCodes, WindFrame};
use bytes::Bytes;
use shared::wire::codec::{self, Shape};
use std::sync::Arc;

/// A grid of codes.
pub trait Grid {
    /// How they lie.
    fn shape(&self) -> Shape;
    /// The codes, plane after plane.
    fn codes(&self) -> &[i8];
}

impl Grid for WindFrame {
    fn shape(&self) -> Shape {
        Shape::wind(self.cells[0] as usize, self.has_dust())
    }
    fn codes(&self) -> &[i8] {
        &self.codes
    }
}

impl Grid for PatchCodes {
    fn shape(&self) -> Shape {
        Shape::patch((self.codes.len() / 3).isqrt())
    }
    fn codes(&self) -> &[i8] {
        &self.codes
    }
}

/// When a grid that has changed is given a new frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pacing {
    /// Largest change of any code that may wait (codes); a larger one gets a frame at the next publish.
    pub dead_band: u8,
    /// Publishes that a change within the dead band waits at most.
    pub slow_every: u64,
}

/// Where a frame stands in its track.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Numbering {
    /// Number of the frame.
    pub seq: u32,
    /// Whether it is coded against zero rather than against the frame before.
    pub key: bool,
}

/// The frames of one grid, numbered upwards from the publish at which the track was begun. There is at most one frame a publish, so a track
/// that is dropped and begun anew never gives a number twice.
#[derive(Debug)]
pub struct Track<G> {
    seq: u32,
    now: Option<Arc<G>>,
    before: Option<Arc<G>>,
    offered_at: u64,
    slow_at: u64,
    delta: Option<Bytes>,
    key: Option<Bytes>,
}

impl<G: Grid> Track<G> {
    /// A track whose first frame is the newest grid (none: at rest). Its first slow frame is due at publish `slow_at`; spread these, lest the
    /// slow frames of many tracks fall together.
    pub fn new(publish: u64, newest: Option<&Arc<G>>, slow_at: u64) -> Self {
        Self { seq: publish as u32, now: newest.cloned(), before: None, offered_at: publish, slow_at, delta: None, key: None }
    }

    /// Publish at which a grid was offered last.
    pub fn offered_at(&self) -> u64 {
        self.offered_at
    }

    /// Takes the newest grid of this publish (none: at rest); decides once a publish whether it becomes the next frame.
    /// What clients hold then differs from the newest grid by at most `pacing.dead_band` in any code, and by nothing after
    /// `pacing.slow_every` publishes without a change.
    pub fn offer(&mut self, publish: u64, newest: Option<&Arc<G>>, pacing: Pacing) {
        if self.offered_at == publish {
            return;
        }
        self.offered_at = publish;
        let difference = difference(self.now.as_ref(), newest);
        let due = publish >= self.slow_at;
        if difference > pacing.dead_band || (difference > 0 && due) {
            self.before = std::mem::replace(&mut self.now, newest.cloned());
            (self.delta, self.key) = (None, None);
            self.seq = self.seq.wrapping_add(1);
            self.slow_at = publish + pacing.slow_every;
        }
    }

    /// The message that brings a client from frame `held` (none: it is not known to hold any) to the newest one, and the newest one's
    /// number; none when it holds that.
    /// `write` makes the message of a payload and counts as one encoding; it is called only if nobody asked before.
    pub fn message(&mut self, held: Option<u32>, write: impl FnOnce(Numbering, Vec<u8>) -> Bytes) -> Option<(u32, Bytes)> {
        if held == Some(self.seq) {
            return None;
        }
        let follows = held.is_some_and(|held| held.wrapping_add(1) == self.seq);
        let base = self.before.as_ref().filter(|_| follows && self.now.is_some());
        let slot = if base.is_some() { &mut self.delta } else { &mut self.key };
        let numbering = Numbering { seq: self.seq, key: base.is_none() };
        let message = slot.get_or_insert_with(|| {
            let payload = self.now.as_ref().map(|now| codec::encode(now.shape(), now.codes(), base.map(|base| base.codes())));
            write(numbering, payload.unwrap_or_default())
        });
        Some((self.seq, message.clone()))
    }
}

/// Largest difference of any code; a grid that is none is all zero.
fn difference<G: Grid>(a: Option<&Arc<G>>, b: Option<&Arc<G>>) -> u8 {
    match (a, b) {
        (None, None) => 0,
        (Some(a), Some(b)) if Arc::ptr_eq(a, b) => 0,
        (Some(a), Some(b)) => a.codes().iter().zip(b.codes()).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0),
        (Some(one), None) | (None, Some(one)) => one.codes().iter().map(|code| code.unsigned_abs()).max().unwrap_or(0),
    }
}
