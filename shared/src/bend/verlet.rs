//! Explicit Verlet integration (Chen & Johan Eqs 2–6).
//!
//! With λ = 1 − exp(−k·dt) and r = c·dt/h a cell becomes `θ⁺ = θ + (1 − λ)·(θ − θ⁻) + r²·(Σ neighbours − 4θ) − κ·dt²·θ`, likewise for both components
//! of ω. When dt changes, θ⁻ is adjusted first, to keep (θ − θ⁻)/dt.
//!
//! Where c varies by Eq. (4), [`Damping::Plain`](super::Damping) keeps the motion θ − θ⁻, as Chen & Johan do. A wave's energy is `(θ'/c)² + |∇θ|²`: each fall of
//! c adds to it, and the oscillating |ω| drives θ up without end, however short the steps (Hill's equation; 250 000 rad in one of 5000 random draws).
//! [`Damping::Exact`](super::Damping) keeps the momentum `p = θ'/c` instead, in the equations `θ' = c·p`, `p' = c·(L − κ/c₀²)·θ − k·p`, whose energy
//! `p² + |∇θ|² + (κ/c₀²)·θ²` no change of c alters. Their leapfrog, with φ of [`Coefficients`] and r⁻ and r⁺ the Courant numbers at the mean ω of the last two
//! and the next two states (ω⁺ comes first, and doesn't depend on θ), is `θ⁺ = θ + (1 − λ)·(r⁺/r⁻)·(θ − θ⁻) + r⁺·½(r⁻ + r⁺)·(Σ neighbours − 4θ − κ·(h/c₀)²·θ)`.
//!
//! A sub-step without damping keeps `⟨v/r⁺, v/r⁺⟩ − ⟨θ⁺, A·θ⟩` with `v = θ⁺ − θ`, up to `⟨(r⁻² − r⁺²)·A·θ, A·θ⟩/4` where r varies, A being the last
//! bracket; that term is of second order, and takes as it gives unless c oscillates within a few sub-steps.
//!
//! A patch does up to [`HALO`] sub-steps while it is in the cache: its halo then contains as many rings of its neighbours' cells, and each sub-step
//! uses up one. The neighbours compute these cells, too, with the same bits.

use super::Coefficients;
use super::kernel::{self, Block};
use super::patch::{HALO, Patch, PatchKinds};
use super::tiles::TILE;

/// Sub-steps of a patch between two exchanges.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pass<'a> {
    /// Coefficients of each kind of grass.
    pub(super) kinds: &'a [Coefficients],
    /// Number of sub-steps, at most [`HALO`].
    pub(super) substeps: usize,
    /// Length of a sub-step relative to the last one.
    pub(super) ratio: f32,
    /// Rings of the halo that each sub-step advances; `None` for as many as the later ones need.
    pub(super) rings: Option<usize>,
    /// Largest |θ| (rad).
    pub(super) limit_rad: f32,
}

/// Advances the active tiles of a patch.
pub(super) fn advance(patch: &mut Patch, pass: &Pass<'_>) {
    patch.cells_stepped = 0;
    if !patch.tiles.any_active() {
        return;
    }
    let bands = -1..=patch.tiles.count() as i64;
    let (mut cells, mut spans) = (0, Spans::default());
    if pass.ratio != 1.0 {
        for band in bands.clone() {
            find_spans(patch, band, [HALO as i64; 2], Join::Ghosts, &mut spans);
            spans.as_slice().iter().for_each(|span| retime(patch, band, *span, pass.ratio));
        }
    }
    for substep in 1..=pass.substeps {
        let rings = pass.rings.unwrap_or(pass.substeps - substep) as i64;
        // Rows of whole SIMD vectors: ghosts beyond the rings get arbitrary values, which only other such ghosts read before the next exchange.
        let columns = if pass.rings.is_none() && rings > 0 { HALO as i64 } else { rings };
        let is_last = substep == pass.substeps;
        for band in bands.clone() {
            find_spans(patch, band, [columns, rings], if is_last { Join::Own } else { Join::Ghosts }, &mut spans);
            if spans.as_slice().is_empty() {
                continue;
            }
            let mut peaks = is_last.then(Peaks::default);
            for span in spans.as_slice() {
                cells += own_cells(patch, band, *span);
                advance_span(patch, pass, band, rings, *span, peaks.as_mut());
            }
            if let Some(peaks) = peaks {
                peaks.record(patch, band);
            }
        }
        std::mem::swap(&mut patch.now, &mut patch.before);
    }
    patch.cells_stepped = cells;
}

/// Spans of columns in a band of tiles, ascending; at most every other tile, rings included, begins one.
#[derive(Default)]
struct Spans {
    spans: [[i64; 2]; SIDE_LIMIT / TILE / 2 + 2],
    count: usize,
}

impl Spans {
    fn as_slice(&self) -> &[[i64; 2]] {
        &self.spans[..self.count]
    }

    /// Adds a span, which continues the last one if it begins at its end and `joins`.
    fn add(&mut self, [from, to]: [i64; 2], joins: bool) {
        match self.spans[..self.count].last_mut() {
            Some(last) if last[1] == from && joins => last[1] = to,
            _ => {
                self.spans[self.count] = [from, to];
                self.count += 1;
            }
        }
    }
}

/// Whether cells of the patch and ghosts form one span.
#[derive(Clone, Copy, PartialEq)]
enum Join {
    /// Cells and ghosts together.
    Ghosts,
    /// Only the patch's own cells, the only ones measured.
    Own,
}

/// Cells of a tile along one axis, with `rings` rings of the halo.
fn extent(patch: &Patch, tile: i64, rings: i64) -> [i64; 2] {
    match tile {
        -1 => [-rings, 0],
        tile if tile == patch.tiles.count() as i64 => [patch.side() as i64, patch.side() as i64 + rings],
        tile => [tile * TILE as i64, (tile + 1) * TILE as i64],
    }
}

/// Spans of columns of the stepping tiles in a band of tiles, with `columns` and `rows` of the halo; bands −1 and `count` are in the halo.
fn find_spans(patch: &Patch, band: i64, [columns, rows]: [i64; 2], join: Join, spans: &mut Spans) {
    let count = patch.tiles.count() as i64;
    spans.count = 0;
    if rows == 0 && !(0..count).contains(&band) {
        return;
    }
    for tile in (-1..=count).filter(|&tile| patch.tiles.steps(tile, band)) {
        let [from, to] = extent(patch, tile, columns);
        let joins = join == Join::Ghosts || (1..count).contains(&tile);
        if from < to {
            spans.add([from, to], joins);
        }
    }
}

/// Number of cells of a span of columns in a band that are not ghosts.
fn own_cells(patch: &Patch, band: i64, [from, to]: [i64; 2]) -> u64 {
    let is_own = (0..patch.tiles.count() as i64).contains(&band);
    if is_own { TILE as u64 * (to.min(patch.side() as i64) - from.max(0)).max(0) as u64 } else { 0 }
}

/// Moves the earlier state of a span of columns along the line through both states, so that rates of change are preserved.
fn retime(patch: &mut Patch, band: i64, [from, to]: [i64; 2], ratio: f32) {
    let [first, last] = extent(patch, band, HALO as i64);
    for row in first..last {
        let cells = patch.at(from, row)..patch.at(to - 1, row) + 1;
        for (now, before) in patch.now.iter().zip(&mut patch.before) {
            let pairs = now[cells.clone()].iter().zip(&mut before[cells.clone()]);
            pairs.for_each(|(now, before)| *before = now - (now - *before) * ratio);
        }
    }
}

/// Largest |θ| and |ω|² in each column of a band, as bits.
struct Peaks {
    theta: [u32; SIDE_LIMIT],
    omega2: [u32; SIDE_LIMIT],
}

/// Largest number of cells along a side.
pub(super) const SIDE_LIMIT: usize = 256;

impl Default for Peaks {
    fn default() -> Self {
        Self { theta: [0; SIDE_LIMIT], omega2: [0; SIDE_LIMIT] }
    }
}

impl Peaks {
    fn record(&self, patch: &mut Patch, band: i64) {
        let count = patch.tiles.count();
        if !(0..count as i64).contains(&band) {
            return;
        }
        for tile in 0..count {
            if !patch.tiles.steps(tile as i64, band) {
                continue;
            }
            let largest = |columns: &[u32]| columns[tile * TILE..][..TILE].iter().copied().max().unwrap_or_default();
            patch.tiles.set_peaks(tile, band as usize, [largest(&self.theta), largest(&self.omega2)]);
        }
    }
}

/// Advances a span of columns in the rows of a band.
fn advance_span(
    patch: &mut Patch,
    &Pass { kinds, limit_rad, .. }: &Pass<'_>,
    band: i64,
    rings: i64,
    [from, to]: [i64; 2],
    mut peaks: Option<&mut Peaks>,
) {
    let (side, stride) = (patch.side() as i64, patch.stride());
    let [first, last] = extent(patch, band, rings);
    // Ghosts have no peaks; their own patch reports them.
    let is_own = 0 <= from && to <= side;
    let (start, width) = (patch.at(from, first), (to - from) as usize);
    let (now, before) = (&patch.now, &mut patch.before);
    let mut advance = |block: Block| {
        let column = (block.first - start) % stride + from.max(0) as usize;
        match peaks.as_deref_mut().filter(|_| is_own) {
            Some(peaks) => {
                let columns = column..column + block.width;
                kernel::advance_and_measure(now, before, block, [&mut peaks.theta[columns.clone()], &mut peaks.omega2[columns]]);
            }
            None => kernel::advance(now, before, block),
        }
    };
    let rows = (last - first) as usize;
    match &patch.ground {
        PatchKinds::One(kind) => advance(Block { first: start, width, rows, stride, k: &kinds[usize::from(*kind)], limit_rad }),
        PatchKinds::Map(_) => {
            for first in (0..rows).map(|row| start + row * stride) {
                for_each_kind(&patch.ground, first, first + width, |kind, from, to| {
                    advance(Block { first: from, width: to - from, rows: 1, stride, k: &kinds[usize::from(kind)], limit_rad });
                });
            }
        }
    }
}

/// Splits cells `first..last` of the planes into runs of one kind.
pub(super) fn for_each_kind(ground: &PatchKinds, first: usize, last: usize, mut act: impl FnMut(u8, usize, usize)) {
    match ground {
        PatchKinds::One(kind) => act(*kind, first, last),
        PatchKinds::Map(kinds) => {
            let mut from = first;
            for run in kinds[first..last].chunk_by(|a, b| a == b) {
                act(run[0], from, from + run.len());
                from += run.len();
            }
        }
    }
}
