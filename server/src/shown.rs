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
}

impl Shown {
    /// The codes of all patches that are not at rest.
    pub(crate) fn patches(&self) -> &Arc<BentPatches> {
        &self.patches
    }

    /// Renews what changed: in patches that are awake, and in those `in_sight` that are only laid.
    pub(crate) fn renew(&mut self, tick: u64, meadow: &mut Meadow, in_sight: impl Fn(PatchIndex) -> bool) {
        let laid_changed: BTreeMap<PatchIndex, bool> = meadow.laid().patches().collect();
        let mut sources: BTreeMap<_, _> =
            meadow.field().awake().map(|patch| (patch.index(), Sources { awake: true, laid: false })).collect();
        for &index in laid_changed.keys() {
            let source = sources.get(&index).map_or(in_sight(index).then_some(false), |_| Some(true));
            if let Some(awake) = source {
                sources.insert(index, Sources { awake, laid: true });
            }
        }
        let (before, meadow_now) = (&self.patches, &*meadow);
        let show = |(&index, source): (&PatchIndex, &Sources)| {
            let patch = meadow_now.field().patch(index);
            let before = before.get(&index);
            let is_known = self.sources.get(&index) == Some(source) && laid_changed.get(&index) != Some(&true);
            let codes = match (patch, is_known) {
                (None, true) => return before.map(|before| (index, Arc::clone(before))),
                (Some(patch), true) if !patch.changed_tiles().contains(&true) => return before.map(|before| (index, Arc::clone(before))),
                (Some(patch), true) => renewed(before.map(|before| before.codes.as_slice()), patch, meadow_now),
                _ => anew(index, patch, meadow_now),
            };
            match before {
                Some(before) if before.codes == codes => Some((index, Arc::clone(before))),
                _ if are_zero(&codes) => None,
                _ => Some((index, Arc::new(PatchCodes { tick, codes }))),
            }
        };
        self.patches = Arc::new(sources.par_iter().filter_map(show).collect());
        self.sources = sources;
        meadow.was_shown();
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
