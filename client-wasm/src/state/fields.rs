//! The streamed fields: 16-bit codes of patches and wind, synchronised with the server by key frames and sequence numbers.

use super::error::{MirrorError, range};
use prairie_core::grid::{PatchIndex, PatchLayout};
use prairie_core::scene::{Scene, Wind};
use prairie_core::wire::{PATCH_MEMORY, Shape, TurbulenceState, codec};
use std::collections::{BTreeSet, HashMap, VecDeque};

/// Maximum number of patches stored; the least recently updated one is evicted. 4096 patches of 64² cells take 100 MB.
pub const PATCH_LIMIT: usize = 4096;
const _: () = assert!(PATCH_LIMIT >= PATCH_MEMORY, "the server relies on the client remembering this many patches");

/// Codes of one patch: three planes (θ, ωx, ωz) of `cells × cells` and, where snow lies, a fourth of the differences in its depth.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PatchCodes {
    planes: Vec<i16>,
}

impl PatchCodes {
    /// Planes θ, ωx, ωz, each in rows from north to south.
    pub fn planes(&self) -> [&[i16]; 3] {
        std::array::from_fn(|i| self.plane(i))
    }

    /// Differences in the depth of the snow, as [`planes`](Self::planes); `None` where no snow lies.
    pub fn snow(&self) -> Option<&[i16]> {
        (Shape::of_patch(self.planes.len()).planes > 3).then(|| self.plane(3))
    }

    fn plane(&self, plane: usize) -> &[i16] {
        let cells = Shape::of_patch(self.planes.len()).width.pow(2);
        &self.planes[plane * cells..(plane + 1) * cells]
    }
}

#[derive(Clone, Debug)]
struct Entry {
    seq: u32,
    updated: u64,
    codes: Option<PatchCodes>,
}

/// All patches received.
#[derive(Clone, Debug, Default)]
pub(super) struct PatchFields {
    entries: HashMap<PatchIndex, Entry>,
    dirty: BTreeSet<PatchIndex>,
    clock: u64,
}

impl PatchFields {
    pub(super) fn apply(&mut self, scene: &Scene, patch: PatchIndex, seq: u32, key: bool, payload: &[u8]) -> Result<(), MirrorError> {
        let patches = PatchLayout::from(&scene.patches).patches();
        if patch as usize >= patches {
            return Err(range("patch index", patch, format!("0..{patches}")));
        }
        let at_rest = payload.is_empty();
        let base = self.entries.get(&patch).filter(|entry| entry.seq.wrapping_add(1) == seq);
        if base.is_none() && !key && !at_rest {
            return Ok(());
        }
        let codes = if at_rest {
            None
        } else {
            let shape = Shape::patch_of(scene);
            let start = if key { None } else { base.and_then(|entry| entry.codes.as_ref()) };
            let mut planes = start.map_or_else(|| vec![0; shape.planes * shape.width * shape.width], |codes| codes.planes.clone());
            codec::decode(shape, payload, &mut planes).map_err(|error| MirrorError::Field { field: "patch", error })?;
            Some(PatchCodes { planes })
        };
        self.store(patch, Entry { seq, updated: 0, codes });
        Ok(())
    }

    fn store(&mut self, patch: PatchIndex, entry: Entry) {
        self.clock += 1;
        self.entries.insert(patch, Entry { updated: self.clock, ..entry });
        self.dirty.insert(patch);
        if self.entries.len() > PATCH_LIMIT {
            let oldest = self.entries.iter().min_by_key(|(_, entry)| entry.updated).map(|(&index, _)| index);
            if let Some(oldest) = oldest {
                self.entries.remove(&oldest);
                self.dirty.insert(oldest);
            }
        }
    }

    /// Sets the codes of a patch, `None` at rest. Only a key frame of the server can replace them.
    pub(super) fn set(&mut self, patch: PatchIndex, codes: Option<&[i16]>) {
        let codes = codes.map(|codes| PatchCodes { planes: codes.to_vec() });
        self.store(patch, Entry { seq: 0, updated: 0, codes });
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

    /// Memory of the codes (bytes).
    pub(super) fn memory_bytes(&self) -> usize {
        self.entries.values().flat_map(|entry| &entry.codes).map(|codes| size_of_val(codes.planes.as_slice())).sum()
    }

    /// Marks all bent patches as changed.
    pub(super) fn touch(&mut self) {
        let Self { entries, dirty, .. } = self;
        dirty.extend(entries.iter().filter(|(_, entry)| entry.codes.is_some()).map(|(&index, _)| index));
    }

    pub(super) fn has_dirty(&self) -> bool {
        !self.dirty.is_empty()
    }

    pub(super) fn take_dirty(&mut self) -> Vec<PatchIndex> {
        std::mem::take(&mut self.dirty).into_iter().collect()
    }
}

/// Codes of the wind at one tick: three planes (u, v, w), x fastest, then y, then z. A scene with dust has a fourth plane, its concentration.
#[derive(Clone, Debug, PartialEq)]
pub struct WindCodes {
    cells: [u32; 3],
    tick: u64,
    seq: u32,
    turbulence: TurbulenceState,
    codes: Vec<i16>,
    is_calm: bool,
}

impl WindCodes {
    /// Number of cells along X, Y and Z.
    pub fn cells(&self) -> [u32; 3] {
        self.cells
    }

    /// World step of this frame.
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// Sequence number of this frame.
    pub fn seq(&self) -> u32 {
        self.seq
    }

    /// State of the gusts between the cells.
    pub fn turbulence(&self) -> &TurbulenceState {
        &self.turbulence
    }

    /// Whether all cells are free of wind and dust.
    pub fn is_calm(&self) -> bool {
        self.is_calm
    }

    /// All codes, plane after plane.
    pub fn codes(&self) -> &[i16] {
        &self.codes
    }
}

/// The wind between two frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShownWind<'a> {
    /// Frame before the moment shown.
    pub from: &'a WindCodes,
    /// Frame after it.
    pub to: &'a WindCodes,
    /// Weight of the frame after it, 0..=1.
    pub fraction: f32,
}

impl ShownWind<'_> {
    /// State of the gusts at this moment.
    pub fn turbulence(&self) -> TurbulenceState {
        self.from.turbulence.towards(&self.to.turbulence, self.fraction.into())
    }
}

/// Header of a wind frame on the wire.
#[derive(Clone, Copy, Debug)]
pub(super) struct WindHeader {
    pub(super) tick: u64,
    pub(super) seq: u32,
    pub(super) key: bool,
    pub(super) turbulence: TurbulenceState,
}

/// Number of wind frames kept at least: they span the delay at which the wind is shown, even if the next one is late.
const WIND_FRAMES: usize = 6;
/// Number of wind frames kept at most, for the steps of a replica that has yet to catch up (about 15 s), and memory of their codes (bytes).
const WIND_FRAMES_LIMIT: usize = 100;
const WIND_LIMIT_BYTES: usize = 16 << 20;

/// The newest wind frames, oldest first. The last one is the base of the next delta.
#[derive(Clone, Debug, Default)]
pub(super) struct WindFrames {
    frames: VecDeque<WindCodes>,
}

impl WindFrames {
    /// Decodes a frame. Returns whether it is new; a delta without its base is not.
    pub(super) fn apply(&mut self, wind: &Wind, header: WindHeader, payload: &[u8]) -> Result<bool, MirrorError> {
        let WindHeader { tick, seq, key, turbulence } = header;
        if !turbulence.is_finite() {
            return Err(range("turbulence of the wind", format!("{turbulence:?}"), "finite numbers"));
        }
        let cells = wind.cells;
        let shape = Shape::wind(cells[0] as usize, wind.has_dust());
        let count = shape.planes * cells.iter().map(|&n| n as usize).product::<usize>();
        let mut codes = match self.frames.back() {
            _ if key => vec![0; count],
            Some(base) if base.seq.wrapping_add(1) == seq => base.codes.clone(),
            _ => return Ok(false),
        };
        codec::decode(shape, payload, &mut codes).map_err(|error| MirrorError::Field { field: "wind", error })?;
        let is_calm = codes.iter().all(|&code| code == 0);
        match self.frames.back() {
            Some(newest) if newest.tick == tick => drop(self.frames.pop_back()),
            // An earlier tick is that of a world that was restarted, or of the state from which a replica starts.
            Some(newest) if newest.tick > tick => self.frames.clear(),
            _ => {}
        }
        let limit = (WIND_LIMIT_BYTES / size_of_val(codes.as_slice()).max(1)).clamp(WIND_FRAMES, WIND_FRAMES_LIMIT);
        while self.frames.len() >= limit {
            self.frames.pop_front();
        }
        self.frames.push_back(WindCodes { cells, tick, seq, turbulence, codes, is_calm });
        Ok(true)
    }

    /// Copies of the frames in use at `tick` or after it.
    pub(super) fn since(&self, tick: u64) -> Self {
        let next = self.frames.partition_point(|frame| frame.tick <= tick);
        Self { frames: self.frames.range(next.saturating_sub(1)..).cloned().collect() }
    }

    /// Memory of the codes (bytes).
    pub(super) fn memory_bytes(&self) -> usize {
        self.frames.iter().map(|frame| size_of_val(frame.codes.as_slice())).sum()
    }

    /// The newest frame.
    pub(super) fn newest(&self) -> Option<&WindCodes> {
        self.frames.back()
    }

    /// The newest frame of a step or before it: that in which the world does the step.
    pub(super) fn frame_of(&self, tick: u64) -> Option<&WindCodes> {
        let next = self.frames.partition_point(|frame| frame.tick <= tick);
        self.frames.get(next.checked_sub(1)?)
    }

    /// The wind at a `tick`, linear between frames; before the first and after the last that of the nearest frame.
    pub(super) fn at(&self, tick: f64) -> Option<ShownWind<'_>> {
        let next = self.frames.partition_point(|frame| frame.tick as f64 <= tick);
        let to = self.frames.get(next).or(self.frames.back())?;
        let from = next.checked_sub(1).map_or(to, |last| &self.frames[last]);
        let span = to.tick - from.tick;
        let fraction = if span > 0 { (tick - from.tick as f64) / span as f64 } else { 0.0 };
        Some(ShownWind { from, to, fraction: fraction as f32 })
    }
}
