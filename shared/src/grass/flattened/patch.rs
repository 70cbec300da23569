//! Flattened grass of one patch.

use super::{Clock, QUANTUM_RAD, REWRITE_FRACTION, VISIBLE_RAD, cell_at, units_rad};
use crate::bend::TILE;
use crate::grass::vector::length;

/// The flattened grass of one patch.
#[derive(Clone, Debug)]
pub(super) struct FlattenedPatch {
    /// Row by row from the north-west.
    pub(super) tiles: Vec<Option<Box<FlattenedTile>>>,
    pub(super) count: usize,
    /// Revision in which it last changed.
    pub(super) changed_in: u64,
}

/// Leans along X and Z in quanta, as written at `since_secs`.
#[derive(Clone, Debug)]
pub(super) struct FlattenedTile {
    pub(super) since_secs: f64,
    pub(super) leans: [[i16; 2]; TILE * TILE],
}

impl FlattenedPatch {
    /// Drops tiles that are no longer visible.
    pub(super) fn drop_invisible(&mut self, clock: &Clock) {
        for tile in &mut self.tiles {
            if tile.as_ref().is_some_and(|tile| tile.largest_rad() * clock.remaining(tile.since_secs) < VISIBLE_RAD) {
                *tile = None;
                self.count -= 1;
            }
        }
    }
}

impl FlattenedTile {
    /// Largest lean as it was written (rad).
    fn largest_rad(&self) -> f32 {
        self.leans.iter().map(|&lean| length(lean.map(units_rad))).fold(0.0, f32::max)
    }
}

/// Flattened grass of one patch, apart from that of the others for as long as the patch is pressed.
#[derive(Debug)]
pub struct DetachedPatch {
    /// `None` where no grass is flattened.
    patch: Option<FlattenedPatch>,
    clock: Clock,
    tiles_across: usize,
    revision: u64,
    /// Time at which a tile was written (s), and what remains of its leans now.
    newest: (f64, f32),
}

impl DetachedPatch {
    pub(super) fn new(patch: Option<FlattenedPatch>, clock: Clock, tiles_across: usize, revision: u64) -> Self {
        Self { patch, clock, tiles_across, revision, newest: (clock.now_secs, 1.0) }
    }

    pub(super) fn into_patch(self) -> Option<FlattenedPatch> {
        self.patch
    }

    /// Lean of cell `(i, j)` (rad); see [`FlattenedGrass::lean_rad`](super::FlattenedGrass::lean_rad).
    pub(in crate::grass) fn lean_rad(&mut self, i: usize, j: usize) -> [f32; 2] {
        let at = self.tile_at(i, j);
        let Some(tile) = self.patch.as_ref().and_then(|patch| patch.tiles[at].as_deref()) else { return [0.0; 2] };
        let (since_secs, units) = (tile.since_secs, tile.leans[cell_at(i, j)]);
        let remaining = self.remaining(since_secs);
        units.map(|units| units_rad(units) * remaining)
    }

    /// Flattens cell `(i, j)` with a lean of at most a right angle (rad). Returns the rounded lean.
    pub(in crate::grass) fn flatten(&mut self, i: usize, j: usize, lean_rad: [f32; 2]) -> [f32; 2] {
        let (now_secs, at, tiles) = (self.clock.now_secs, self.tile_at(i, j), self.tiles_across * self.tiles_across);
        let written_at_secs = self.patch.as_ref().and_then(|patch| patch.tiles[at].as_ref()).map_or(now_secs, |tile| tile.since_secs);
        let mut remaining = self.remaining(written_at_secs);
        let empty = || FlattenedPatch { tiles: vec![None; tiles], count: 0, changed_in: 0 };
        let patch = self.patch.get_or_insert_with(empty);
        patch.changed_in = self.revision;
        let tile = patch.tiles[at].get_or_insert_with(|| {
            patch.count += 1;
            Box::new(FlattenedTile { since_secs: now_secs, leans: [[0; 2]; TILE * TILE] })
        });
        if remaining < REWRITE_FRACTION {
            tile.leans.iter_mut().flatten().for_each(|units| *units = (f32::from(*units) * remaining) as i16);
            (tile.since_secs, remaining) = (now_secs, 1.0);
        }
        let units = lean_rad.map(|rad| {
            let cut = (rad / (remaining * QUANTUM_RAD)) as i16;
            // The quotient of a lean just below a quantum may round up to it.
            if (units_rad(cut) * remaining).abs() > rad.abs() { cut - cut.signum() } else { cut }
        });
        tile.leans[cell_at(i, j)] = units;
        units.map(|units| units_rad(units) * remaining)
    }

    /// What remains of a lean written at `since_secs`.
    fn remaining(&mut self, since_secs: f64) -> f32 {
        if self.newest.0 != since_secs {
            self.newest = (since_secs, self.clock.remaining(since_secs));
        }
        self.newest.1
    }

    fn tile_at(&self, i: usize, j: usize) -> usize {
        j / TILE * self.tiles_across + i / TILE
    }
}
