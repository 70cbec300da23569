//! The bend field as clients are shown it: 8-bit codes of each patch, renewed where something changed.

use crate::bend::{Meadow, sward};
use crate::snapshot::{BentPatches, PatchCodes};
use rayon::prelude::*;
use shared::bend::{Bend, Patch, TILE};
use shared::grid::PatchIndex;
use shared::wire::quantise;
use std::collections::BTreeMap;
use std::sync::Arc;

/// What the codes of a patch come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Sources {
    awake: bool,
    laid: bool,
}

/// The codes shown last.
#[derive(Debug, Default)]
pub(crate) struct Shown {
    patches: Arc<BentPatches>,
    sources: BTreeMap<PatchIndex, Sources>,
    /// Codes of patches renewed since, none where all are zero.
    ahead: BTreeMap<PatchIndex, Option<Arc<PatchCodes>>>,
}

impl Shown {
    /// The codes of all patches that are not at rest.
    pub(crate) fn patches(&self) -> &Arc<BentPatches> {
        &self.patches
    }

    /// Renews one of so many `parts` of the awake patches ahead of the next [`renew`](Self::renew), which then leaves them as they are.
    pub(crate) fn renew_part(&mut self, tick: u64, meadow: &mut Meadow, [part, parts]: [u64; 2]) {
        let is_due = |index: &PatchIndex| u64::from(*index) % parts == part && !self.ahead.contains_key(index);
        let due: Vec<_> = meadow.field().awake().map(Patch::index).filter(is_due).collect();
        let (sources, now) = (&self.sources, &*meadow);
        let show = |index: PatchIndex| {
            let source = sources.get(&index).filter(|source| source.awake)?;
            Some((index, self.show(tick, index, Some(source), now)))
        };
        let shown: Vec<_> = due.into_par_iter().filter_map(show).collect();
        shown.iter().for_each(|(index, _)| meadow.was_shown(*index));
        self.ahead.extend(shown);
    }

    /// Renews what changed: in patches that are awake, and in those `in_sight` that are only laid.
    pub(crate) fn renew(&mut self, tick: u64, meadow: &mut Meadow, in_sight: impl Fn(PatchIndex) -> bool) {
        let mut sources: BTreeMap<_, _> =
            meadow.field().awake().map(|patch| (patch.index(), Sources { awake: true, laid: false })).collect();
        for index in meadow.laid().patches() {
            let source = sources.get(&index).map_or(in_sight(index).then_some(false), |_| Some(true));
            if let Some(awake) = source {
                sources.insert(index, Sources { awake, laid: true });
            }
        }
        let (before, mut ahead) = (&self.sources, std::mem::take(&mut self.ahead));
        ahead.retain(|index, _| sources.get(index).is_some_and(|source| before.get(index) == Some(source)));
        let now = &*meadow;
        let show = |(&index, source): (&PatchIndex, &Sources)| match ahead.get(&index) {
            Some(codes) => Some((index, codes.clone()?)),
            None => Some((index, self.show(tick, index, before.get(&index).filter(|before| *before == source), now)?)),
        };
        self.patches = Arc::new(sources.par_iter().filter_map(show).collect());
        sources.keys().filter(|index| !ahead.contains_key(index)).for_each(|index| meadow.was_shown(*index));
        self.sources = sources;
    }

    /// Codes of a patch, from those shown before where it then had the same `source`; none where all are zero.
    fn show(&self, tick: u64, index: PatchIndex, source: Option<&Sources>, meadow: &Meadow) -> Option<Arc<PatchCodes>> {
        let (patch, before) = (meadow.field().patch(index), self.patches.get(&index));
        let is_known = source.is_some() && !meadow.laid().changed(index);
        let codes = match (patch, is_known) {
            (None, true) => return before.map(Arc::clone),
            (Some(patch), true) if !patch.changed_tiles().contains(&true) => return before.map(Arc::clone),
            (Some(patch), true) => renewed(before.map(|before| before.codes.as_slice()), patch, meadow),
            _ => anew(index, patch, meadow),
        };
        match before {
            Some(before) if before.codes == codes => Some(Arc::clone(before)),
            _ if are_zero(&codes) => None,
            _ => Some(Arc::new(PatchCodes { tick, codes })),
        }
    }
}

/// Whether all codes are zero; a chunk at a time, in vectors.
fn are_zero(codes: &[i8]) -> bool {
    codes.chunks(256).all(|chunk| chunk.iter().fold(0, |any, code| any | code) == 0)
}

/// Three planes of codes: θ, ωx, ωz.
fn anew(index: PatchIndex, patch: Option<&Patch>, meadow: &Meadow) -> Vec<i8> {
    let side = meadow.field().layout().cells as usize;
    let mut codes = vec![0; 3 * side * side];
    if let Some(patch) = patch {
        write_tiles(&mut codes, patch, |_| true);
    }
    add_laid(&mut codes, side, index, patch, meadow, |_| true);
    codes
}

/// Codes of which only the tiles that changed are made anew.
fn renewed(before: Option<&[i8]>, patch: &Patch, meadow: &Meadow) -> Vec<i8> {
    let side = patch.side();
    let mut codes = before.map_or_else(|| vec![0; 3 * side * side], <[i8]>::to_vec);
    let changed = patch.changed_tiles();
    write_tiles(&mut codes, patch, |tile| changed[tile]);
    add_laid(&mut codes, side, patch.index(), Some(patch), meadow, |tile| changed[tile]);
    codes
}

/// Writes the chosen tiles, those side by side at once.
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
                let place = |channel: usize| channel * plane + row.start..channel * plane + row.end;
                quantise::theta_codes(theta, &mut codes[place(0)]);
                quantise::omega_codes(x, &mut codes[place(1)]);
                quantise::omega_codes(z, &mut codes[place(2)]);
            }
        }
    }
}

/// Adds what is laid in the chosen tiles of a patch.
fn add_laid(codes: &mut [i8], side: usize, index: PatchIndex, patch: Option<&Patch>, meadow: &Meadow, chosen: impl Fn(usize) -> bool) {
    let plane = side * side;
    for ([i, j], lean_rad) in meadow.laid().cells(index).filter(|([i, j], _)| chosen(j / TILE * (side / TILE) + i / TILE)) {
        let bend = sward::shown(patch.map_or_else(Bend::default, |patch| patch.bend(i, j)), lean_rad);
        let at = j * side + i;
        codes[at] = quantise::theta_code(bend.theta);
        codes[plane + at] = quantise::omega_code(bend.omega[0]);
        codes[2 * plane + at] = quantise::omega_code(bend.omega[1]);
    }
}
