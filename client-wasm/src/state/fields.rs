//! The streamed fields: 8-bit codes of patches and wind, synchronised with the server by key frames and sequence numbers.

use super::error::{MirrorError, range};
use prairie_core::grid::{PatchIndex, PatchLayout};
use prairie_core::scene::Wind;
use prairie_core::wire::{PATCH_MEMORY, Shape, codec};
use std::collections::{BTreeSet, HashMap};

/// Maximum number of patches stored; the least recently updated one is evicted. 4096 patches of 64² cells take 50 MB.
pub const PATCH_LIMIT: usize = 4096;
const _: () = assert!(PATCH_LIMIT >= PATCH_MEMORY, "the server relies on the client remembering this many patches");

/// Codes of one patch: three planes (θ, ωx, ωz) of `cells × cells`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PatchCodes {
    planes: Vec<i8>,
}

impl PatchCodes {
    /// Planes θ, ωx, ωz, each in rows from north to south.
    pub fn planes(&self) -> [&[i8]; 3] {
        let plane = self.planes.len() / 3;
        std::array::from_fn(|i| &self.planes[i * plane..(i + 1) * plane])
    }
}

#[derive(Debug)]
struct Entry {
    seq: u32,
    updated: u64,
    codes: Option<PatchCodes>,
}

/// All patches received.
#[derive(Debug, Default)]
pub(super) struct PatchFields {
    entries: HashMap<PatchIndex, Entry>,
    dirty: BTreeSet<PatchIndex>,
    clock: u64,
}

impl PatchFields {
    pub(super) fn apply(
        &mut self,
        layout: &PatchLayout,
        patch: PatchIndex,
        seq: u32,
        key: bool,
        payload: &[u8],
    ) -> Result<(), MirrorError> {
        if patch as usize >= layout.patches() {
            return Err(range("patch index", patch, format!("0..{}", layout.patches())));
        }
        let at_rest = payload.is_empty();
        let base = self.entries.get(&patch).filter(|entry| entry.seq.wrapping_add(1) == seq);
        if base.is_none() && !key && !at_rest {
            return Ok(());
        }
        let codes = if at_rest {
            None
        } else {
            let cells = layout.cells as usize;
            let start = if key { None } else { base.and_then(|entry| entry.codes.as_ref()) };
            let mut planes = start.map_or_else(|| vec![0; cells * cells * 3], |codes| codes.planes.clone());
            codec::decode(Shape::patch(cells), payload, &mut planes).map_err(|error| MirrorError::Field { field: "patch", error })?;
            Some(PatchCodes { planes })
        };
        self.clock += 1;
        self.entries.insert(patch, Entry { seq, updated: self.clock, codes });
        self.dirty.insert(patch);
        if self.entries.len() > PATCH_LIMIT {
            let oldest = self.entries.iter().min_by_key(|(_, entry)| entry.updated).map(|(&index, _)| index);
            if let Some(oldest) = oldest {
                self.entries.remove(&oldest);
                self.dirty.insert(oldest);
            }
        }
        Ok(())
    }

    pub(super) fn codes(&self, patch: PatchIndex) -> Option<&PatchCodes> {
        self.entries.get(&patch)?.codes.as_ref()
    }

    pub(super) fn known(&self) -> usize {
        self.entries.len()
    }

    pub(super) fn bent(&self) -> impl Iterator<Item = PatchIndex> + '_ {
        self.entries.iter().filter(|(_, entry)| entry.codes.is_some()).map(|(&index, _)| index)
    }

    pub(super) fn has_dirty(&self) -> bool {
        !self.dirty.is_empty()
    }

    pub(super) fn take_dirty(&mut self) -> Vec<PatchIndex> {
        std::mem::take(&mut self.dirty).into_iter().collect()
    }
}

/// Codes of the wind: three planes (u, v, w), x fastest, then y, then z. A scene with dust has a fourth plane, its concentration.
#[derive(Clone, Debug, PartialEq)]
pub struct WindCodes {
    cells: [u32; 3],
    seq: u32,
    planes: Vec<i8>,
    is_calm: bool,
}

impl WindCodes {
    /// Number of cells along X, Y and Z.
    pub fn cells(&self) -> [u32; 3] {
        self.cells
    }

    /// Sequence number of this frame.
    pub fn seq(&self) -> u32 {
        self.seq
    }

    /// Whether all cells are free of wind and dust.
    pub fn is_calm(&self) -> bool {
        self.is_calm
    }

    fn plane(&self, index: usize) -> &[i8] {
        let volume = volume(self.cells);
        &self.planes[index * volume..][..volume]
    }

    /// Planes u, v, w.
    pub fn planes(&self) -> [&[i8]; 3] {
        [0, 1, 2].map(|index| self.plane(index))
    }

    /// Dust plane; `None` in a scene without dust.
    pub fn dust(&self) -> Option<&[i8]> {
        (self.planes.len() > 3 * volume(self.cells)).then(|| self.plane(3))
    }
}

fn volume(cells: [u32; 3]) -> usize {
    cells.iter().map(|&n| n as usize).product()
}

/// The newest wind frame, which is the base of the next delta.
#[derive(Debug, Default)]
pub(super) struct WindFrames {
    newest: Option<WindCodes>,
}

impl WindFrames {
    pub(super) fn apply(&mut self, wind: &Wind, seq: u32, key: bool, payload: &[u8]) -> Result<(), MirrorError> {
        let cells = wind.cells;
        let shape = Shape::wind(cells[0] as usize, wind.has_dust());
        let count = shape.planes * volume(cells);
        let planes = match &self.newest {
            _ if key => vec![0; count],
            Some(base) if base.seq.wrapping_add(1) == seq => base.planes.clone(),
            _ => return Ok(()),
        };
        let mut planes = planes;
        codec::decode(shape, payload, &mut planes).map_err(|error| MirrorError::Field { field: "wind", error })?;
        let is_calm = planes.iter().all(|&code| code == 0);
        self.newest = Some(WindCodes { cells, seq, planes, is_calm });
        Ok(())
    }

    pub(super) fn codes(&self) -> Option<&WindCodes> {
        self.newest.as_ref()
    }
}
