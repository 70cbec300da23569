//! The numbered frames of one streamed grid, each encoded at most once per kind.

use crate::snapshot::{PatchCodes, WindFrame};
use bytes::Bytes;
use prairie_core::wire::codec::{self, Shape};
use std::sync::Arc;

/// A grid of codes.
pub trait Grid {
    /// Dimensions of the grid.
    fn shape(&self) -> Shape;
    /// The codes, plane after plane.
    fn codes(&self) -> &[i16];
    /// Whether something besides the codes differs.
    fn differs(&self, _other: &Self) -> bool {
        false
    }
}

impl Grid for WindFrame {
    fn shape(&self) -> Shape {
        Shape::wind(self.cells[0] as usize, self.has_dust())
    }
    fn codes(&self) -> &[i16] {
        &self.codes
    }

    /// Gusts travel even in a wind that stays the same.
    fn differs(&self, other: &Self) -> bool {
        self.turbulence != other.turbulence
    }
}

impl Grid for PatchCodes {
    fn shape(&self) -> Shape {
        Shape::of_patch(self.codes.len())
    }
    fn codes(&self) -> &[i16] {
        &self.codes
    }
}

/// Header of an encoded frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameHeader {
    /// Number of the frame.
    pub seq: u32,
    /// Whether the frame is encoded against zero (key) rather than against the previous frame (delta).
    pub key: bool,
}

/// The frames of one grid, numbered from the publication at which this state was created. There is at most one frame per publication, so a
/// state that is dropped and created again never reuses a number.
#[derive(Debug)]
pub struct GridFrames<G> {
    seq: u32,
    now: Option<Arc<G>>,
    before: Option<Arc<G>>,
    offered_at: u64,
    delta: Option<Bytes>,
    key: Option<Bytes>,
}

impl<G: Grid> GridFrames<G> {
    /// Frames that start with the newest grid (`None`: at rest).
    pub fn new(publish: u64, newest: Option<&Arc<G>>) -> Self {
        Self { seq: publish as u32, now: newest.cloned(), before: None, offered_at: publish, delta: None, key: None }
    }

    /// Number of the newest frame.
    pub fn seq(&self) -> u32 {
        self.seq
    }

    /// The last publication at which a grid was offered.
    pub fn offered_at(&self) -> u64 {
        self.offered_at
    }

    /// Offers the newest grid (`None`: at rest), once per publication. If it differs from that of the newest frame, it becomes the next one.
    pub fn offer(&mut self, publish: u64, newest: Option<&Arc<G>>) {
        if self.offered_at == publish {
            return;
        }
        self.offered_at = publish;
        if differ(self.now.as_ref(), newest) {
            self.before = std::mem::replace(&mut self.now, newest.cloned());
            (self.delta, self.key) = (None, None);
            self.seq = self.seq.wrapping_add(1);
        }
    }

    /// The grid of the newest frame (`None`: at rest).
    pub fn newest(&self) -> Option<&Arc<G>> {
        self.now.as_ref()
    }

    /// The message that updates a client from frame `held` (`None`: no frame) to the newest one, and the number of that frame; `None` if the
    /// client is up to date. `write` builds the message from a payload; it is called only for the first client that needs this message.
    pub fn message(&mut self, held: Option<u32>, write: impl FnOnce(FrameHeader, Vec<u8>) -> Bytes) -> Option<(u32, Bytes)> {
        if held == Some(self.seq) {
            return None;
        }
        let follows = held.is_some_and(|held| held.wrapping_add(1) == self.seq);
        let base = self.before.as_ref().filter(|_| follows && self.now.is_some());
        let slot = if base.is_some() { &mut self.delta } else { &mut self.key };
        let header = FrameHeader { seq: self.seq, key: base.is_none() };
        let message = slot.get_or_insert_with(|| {
            let payload = self.now.as_ref().map(|now| codec::encode(now.shape(), now.codes(), base.map(|base| base.codes())));
            write(header, payload.unwrap_or_default())
        });
        Some((self.seq, message.clone()))
    }
}

/// Whether two grids differ; a missing grid is all zero.
fn differ<G: Grid>(a: Option<&Arc<G>>, b: Option<&Arc<G>>) -> bool {
    match (a, b) {
        (None, None) => false,
        (Some(a), Some(b)) => !Arc::ptr_eq(a, b) && (a.codes() != b.codes() || a.differs(b)),
        (Some(one), None) | (None, Some(one)) => one.codes().iter().any(|code| *code != 0),
    }
}
