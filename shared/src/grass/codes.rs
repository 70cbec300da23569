//! Codes of the grass: 8 bits for each channel of a cell, encoded again where something changed.

use super::{BendSimulation, grass_state};
use crate::bend::{Bend, Executor, Patch, TILE};
use crate::grid::PatchIndex;
use crate::wire::quantise;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The bend field by patch. Patches that are missing are at rest.
pub type BentPatches = BTreeMap<PatchIndex, Arc<PatchCodes>>;

/// The bend field of one patch.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PatchCodes {
    /// Step at which the codes last changed.
    pub tick: u64,
    /// Three planes (θ, ωx, ωz) of `cells × cells` codes, row by row from the north-west.
    pub codes: Vec<i8>,
}

/// Sources of a patch's codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Sources {
    is_awake: bool,
    is_flattened: bool,
}

/// Revisions of the bend field and the flattened grass.
#[derive(Clone, Copy, Debug, Default)]
struct Revisions {
    field: u64,
    flattened: u64,
}

impl Revisions {
    fn of(bend: &BendSimulation) -> Self {
        Self { field: bend.field().revision(), flattened: bend.flattened().revision() }
    }
}

/// Quantises the bend field for clients. It keeps the newest codes, so that only tiles that changed are encoded again.
#[derive(Debug, Default)]
pub struct PatchQuantiser {
    patches: Arc<BentPatches>,
    sources: BTreeMap<PatchIndex, Sources>,
    /// Revisions from which each patch was last encoded.
    encoded: BTreeMap<PatchIndex, Revisions>,
    /// Codes of patches encoded ahead of the next snapshot; `None` where all are zero.
    ahead: BTreeMap<PatchIndex, Option<Arc<PatchCodes>>>,
}

impl PatchQuantiser {
    /// Encodes one of `count` parts of the awake patches, `[index, count]`. The next [`quantise`](Self::quantise) uses these codes unchanged.
    pub fn quantise_part(&mut self, tick: u64, bend: &BendSimulation, [part, count]: [u64; 2], executor: &impl Executor) {
        let is_due = |index: &PatchIndex| u64::from(*index) % count == part && !self.ahead.contains_key(index);
        let is_known = |index: &PatchIndex| self.sources.get(index).is_some_and(|source| source.is_awake);
        let due = bend.field().awake().map(Patch::index).filter(|index| is_due(index) && is_known(index));
        let mut codes: Vec<_> = due.map(|index| (index, None)).collect();
        executor.for_each(codes.iter_mut().collect(), |(index, codes)| *codes = self.encode(tick, *index, self.sources.get(index), bend));
        let revisions = Revisions::of(bend);
        self.encoded.extend(codes.iter().map(|(index, _)| (*index, revisions)));
        self.ahead.extend(codes);
    }

    /// Encodes the changed patches: awake ones, and those that have only flattened grass and are `in_sight`. Returns the codes of all patches that are not at
    /// rest.
    pub fn quantise(
        &mut self,
        tick: u64,
        bend: &BendSimulation,
        in_sight: impl Fn(PatchIndex) -> bool,
        executor: &impl Executor,
    ) -> Arc<BentPatches> {
        let sources = sources(bend, in_sight);
        let (before, mut ahead) = (&self.sources, std::mem::take(&mut self.ahead));
        ahead.retain(|index, _| sources.get(index).is_some_and(|source| before.get(index) == Some(source)));
        let mut codes: Vec<_> = sources.keys().map(|index| (*index, None)).collect();
        executor.for_each(codes.iter_mut().collect(), |(index, codes)| {
            let source = sources.get(index);
            *codes = match ahead.get(index) {
                Some(codes) => codes.clone(),
                None => self.encode(tick, *index, before.get(index).filter(|before| source == Some(*before)), bend),
            }
        });
        self.patches = Arc::new(codes.into_iter().filter_map(|(index, codes)| Some((index, codes?))).collect());
        let revisions = Revisions::of(bend);
        self.encoded.retain(|index, _| sources.contains_key(index));
        self.encoded.extend(sources.keys().filter(|index| !ahead.contains_key(index)).map(|index| (*index, revisions)));
        self.sources = sources;
        Arc::clone(&self.patches)
    }

    /// Codes of a patch, or `None` where all are zero. They start from the previous codes when these had the same `source`.
    fn encode(&self, tick: u64, index: PatchIndex, source: Option<&Sources>, bend: &BendSimulation) -> Option<Arc<PatchCodes>> {
        let (patch, before) = (bend.field().patch(index), self.patches.get(&index));
        let since = self.encoded.get(&index).copied().unwrap_or_default();
        let is_known = source.is_some() && !bend.flattened().changed_since(since.flattened, index);
        let codes = match (patch, is_known) {
            (None, true) => return before.map(Arc::clone),
            (Some(patch), true) if !patch.changed_since(since.field).any(|changed| changed) => return before.map(Arc::clone),
            (Some(patch), true) => update(before.map(|before| before.codes.as_slice()), patch, since.field, bend),
            _ => encode_all(index, patch, bend),
        };
        match before {
            Some(before) if before.codes == codes => Some(Arc::clone(before)),
            _ if are_zero(&codes) => None,
            _ => Some(Arc::new(PatchCodes { tick, codes })),
        }
    }
}

/// Patches that are not at rest, with the sources of their codes.
fn sources(bend: &BendSimulation, in_sight: impl Fn(PatchIndex) -> bool) -> BTreeMap<PatchIndex, Sources> {
    let awake = |patch: &Patch| (patch.index(), Sources { is_awake: true, is_flattened: false });
    let mut sources: BTreeMap<_, _> = bend.field().awake().map(awake).collect();
    for index in bend.flattened().patches() {
        let is_awake = sources.contains_key(&index);
        if is_awake || in_sight(index) {
            sources.insert(index, Sources { is_awake, is_flattened: true });
        }
    }
    sources
}

/// Whether all codes are zero; in chunks, for vectorisation.
fn are_zero(codes: &[i8]) -> bool {
    codes.chunks(256).all(|chunk| chunk.iter().fold(0, |any, code| any | code) == 0)
}

/// Codes of all tiles.
fn encode_all(index: PatchIndex, patch: Option<&Patch>, bend: &BendSimulation) -> Vec<i8> {
    let side = bend.field().layout().cells as usize;
    let mut codes = vec![0; 3 * side * side];
    if let Some(patch) = patch {
        write_tiles(&mut codes, patch, |_| true);
    }
    add_flattened(&mut codes, side, index, patch, bend, |_| true);
    codes
}

/// The codes `before`, updated in the tiles that changed since a revision of the field.
fn update(before: Option<&[i8]>, patch: &Patch, since: u64, bend: &BendSimulation) -> Vec<i8> {
    let side = patch.side();
    let mut codes = before.map_or_else(|| vec![0; 3 * side * side], <[i8]>::to_vec);
    let changed: Vec<bool> = patch.changed_since(since).collect();
    write_tiles(&mut codes, patch, |tile| changed[tile]);
    add_flattened(&mut codes, side, patch.index(), Some(patch), bend, |tile| changed[tile]);
    codes
}

/// Writes the chosen tiles, adjacent ones together.
fn write_tiles(codes: &mut [i8], patch: &Patch, chosen: impl Fn(usize) -> bool) {
    let (side, count) = (patch.side(), patch.side() / TILE);
    let plane = side * side;
    for band in 0..count {
        let tiles: Vec<_> = (0..count).filter(|tile| chosen(band * count + tile)).collect();
        for span in tiles.chunk_by(|a, b| a + 1 == *b) {
            let (first, last) = (span[0] * TILE, (span[span.len() - 1] + 1) * TILE);
            for j in band * TILE..(band + 1) * TILE {
                let [theta, x, z] = patch.row(j).map(|row| &row[first..last]);
                let row = j * side + first..j * side + last;
                let range = |channel: usize| channel * plane + row.start..channel * plane + row.end;
                quantise::theta_codes(theta, &mut codes[range(0)]);
                quantise::omega_codes(x, &mut codes[range(1)]);
                quantise::omega_codes(z, &mut codes[range(2)]);
            }
        }
    }
}

/// Adds the flattened grass in the chosen tiles of a patch.
fn add_flattened(
    codes: &mut [i8],
    side: usize,
    index: PatchIndex,
    patch: Option<&Patch>,
    bend: &BendSimulation,
    chosen: impl Fn(usize) -> bool,
) {
    let plane = side * side;
    for ([i, j], lean_rad) in bend.flattened().cells(index).filter(|([i, j], _)| chosen(j / TILE * (side / TILE) + i / TILE)) {
        let bend = grass_state::published(patch.map_or_else(Bend::default, |patch| patch.bend(i, j)), lean_rad);
        let at = j * side + i;
        codes[at] = quantise::theta_code(bend.theta);
        codes[plane + at] = quantise::omega_code(bend.omega[0]);
        codes[2 * plane + at] = quantise::omega_code(bend.omega[1]);
    }
}
