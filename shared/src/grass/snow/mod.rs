//! Snow on the land: a field of depth and mass, in the cells of the bend field.
//!
//! Undisturbed snow has the depth and density of the scene, and needs no memory: tiles, those of activity in [`crate::bend`], exist only where something has
//! pressed the snow, in awake and in sleeping patches, as differences from it. Objects compact the columns below them and push snow aside (Sumner, O'Brien and
//! Hodgins 1999), which conserves mass exactly. Snowfall drifts into ruts, so that the differences decay.

mod checkpoint;
mod column;
mod press;

pub use checkpoint::SnowState;
pub use column::{Column, DEPTH_QUANTUM_M, MASS_QUANTUM_KG_M2};

use crate::bend::TILE;
use crate::grid::{PatchIndex, PatchLayout};
use crate::scene::Snow;
use column::{Yielding, quanta_of, scaled};
use std::collections::BTreeMap;

/// Cells of a tile.
const CELLS: usize = TILE * TILE;
/// Maximum number of tiles: a state of them has less than the 8 MiB that a page takes. With cells of 0.25 m, 16 km of ruts 2 m wide.
pub const TILE_LIMIT: usize = 8192;
/// Fixed-point unit of the decay in a second.
const DECAY_UNIT: i64 = 1 << 32;

/// The snow of a world.
#[derive(Clone, Debug)]
pub struct SnowField {
    layout: PatchLayout,
    /// Undisturbed snow.
    undisturbed: Column,
    yielding: Yielding,
    /// Difference in depth between neighbours above which pushed snow slumps.
    repose: i64,
    /// Decrease of differences in a second, in 1/[`DECAY_UNIT`].
    decay: i64,
    tile_limit: usize,
    /// Number of completed steps.
    revision: u64,
    patches: BTreeMap<PatchIndex, SnowPatch>,
    dropped: u64,
    /// Depth that no column exceeds.
    highest: i64,
}

/// The disturbed snow of one patch.
#[derive(Clone, Debug, PartialEq)]
struct SnowPatch {
    /// Differences from undisturbed snow, row by row from the north-west.
    tiles: Vec<Option<Box<[Column; CELLS]>>>,
    count: usize,
    /// Revision in which it last changed, and in which it was last pressed.
    changed_in: u64,
    pressed_in: u64,
}

impl SnowField {
    /// The undisturbed snow of a scene; `None` if none lies. At most `tile_limit` tiles are kept after each step, and at most [`TILE_LIMIT`].
    pub fn new(layout: PatchLayout, snow: &Snow, tile_limit: usize) -> Option<Self> {
        let undisturbed = Column::new(snow.depth_m, snow.density_kg_m3);
        let decay_per_s = f64::from(snow.fall_m_per_h) / (3600.0 * f64::from(snow.depth_m));
        snow.lies().then(|| Self {
            layout,
            undisturbed,
            yielding: Yielding::new(snow),
            repose: quanta_of(libm::tanf(snow.repose_deg.to_radians()) * layout.cell_m),
            decay: (decay_per_s.min(1.0) * DECAY_UNIT as f64).round() as i64,
            tile_limit: tile_limit.min(TILE_LIMIT),
            revision: 0,
            patches: BTreeMap::new(),
            dropped: 0,
            highest: undisturbed.depth,
        })
    }

    /// Undisturbed snow.
    pub fn undisturbed(&self) -> Column {
        self.undisturbed
    }

    /// Number of tiles, 1 KB each.
    pub fn tiles(&self) -> usize {
        self.patches.values().map(|patch| patch.count).sum()
    }

    /// Number of patches so far whose tracks were dropped because of the limit.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }

    /// Patches with disturbed snow, ascending.
    pub fn patches(&self) -> impl Iterator<Item = PatchIndex> {
        self.patches.keys().copied()
    }

    /// Depth that no column exceeds (m).
    pub fn highest_m(&self) -> f32 {
        (self.highest as f64 * DEPTH_QUANTUM_M) as f32
    }

    /// The column of a cell of the world; undisturbed outside it.
    pub fn column(&self, cell: [i64; 2]) -> Column {
        self.undisturbed.plus(self.difference(cell))
    }

    /// Depth of the snow at a position (m), that of the cell.
    pub fn depth_m(&self, at_m: [f32; 2]) -> f32 {
        self.column(at_m.map(|m| (m / self.layout.cell_m).floor() as i64)).depth_m()
    }

    /// Mass of all snow less that of undisturbed snow (kg).
    pub fn mass_difference_kg(&self) -> f64 {
        let tiles = self.patches.values().flat_map(|patch| patch.tiles.iter().flatten());
        let quanta: i64 = tiles.flat_map(|tile| tile.iter().map(|difference| difference.mass)).sum();
        let cell_m = f64::from(self.layout.cell_m);
        quanta as f64 * MASS_QUANTUM_KG_M2 * cell_m * cell_m
    }

    /// The cells `(i, j)` of a patch whose depth differs from that of undisturbed snow, with the difference in [quanta](DEPTH_QUANTUM_M).
    pub fn differences(&self, patch: PatchIndex) -> impl Iterator<Item = ([usize; 2], i64)> {
        let across = self.tiles_across();
        let tiles = self.patches.get(&patch).into_iter().flat_map(|patch| patch.tiles.iter().enumerate());
        tiles.filter_map(|(at, tile)| Some((at, tile.as_deref()?))).flat_map(move |(at, tile)| {
            let (west, north) = (at % across * TILE, at / across * TILE);
            let cells = tile.iter().enumerate().filter(|(_, difference)| difference.depth != 0);
            cells.map(move |(cell, difference)| ([west + cell % TILE, north + cell / TILE], difference.depth))
        })
    }

    /// Number of completed steps. Pass it to [`changed_since`](Self::changed_since) later to find the patches that have changed.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Whether the snow of a patch may have changed since this [revision](Self::revision).
    pub fn changed_since(&self, revision: u64, patch: PatchIndex) -> bool {
        self.patches.get(&patch).is_some_and(|patch| patch.changed_in >= revision)
    }

    /// State of a patch as words, for hashing.
    pub fn words_of(&self, index: PatchIndex) -> impl Iterator<Item = u32> {
        let tiles = self.patches.get(&index).into_iter().flat_map(|patch| patch.tiles.iter().enumerate());
        let words = |column: &Column| [column.mass as u32, (column.mass >> 32) as u32, column.depth as u32];
        tiles
            .filter_map(|(at, tile)| Some((at, tile.as_deref()?)))
            .flat_map(move |(at, tile)| [index, at as u32].into_iter().chain(tile.iter().flat_map(words)))
    }

    /// Advances time by `dt_secs`. Once a second each patch decays by what has drifted into it, a few patches per step. Above the limit, the patches that were pressed
    /// longest ago lose their tracks first.
    pub fn step(&mut self, dt_secs: f32) {
        let round = (1.0 / dt_secs).round().max(1.0) as u64;
        let (decay, revision) = (self.decay, self.revision);
        self.revision = self.revision.wrapping_add(1);
        if decay > 0 {
            self.patches.retain(|&index, patch| {
                if revision.wrapping_add(index.into()).is_multiple_of(round) {
                    patch.decay(decay);
                    patch.changed_in = revision;
                }
                patch.count > 0
            });
        }
        while self.tiles() > self.tile_limit {
            let oldest = self.patches.iter().min_by_key(|(index, patch)| (patch.pressed_in, **index)).map(|(index, _)| *index);
            let Some(oldest) = oldest else { break };
            self.patches.remove(&oldest);
            self.dropped = self.dropped.wrapping_add(1);
        }
    }

    fn difference(&self, cell: [i64; 2]) -> Column {
        let Some((patch, tile, at)) = self.place(cell) else { return Column::default() };
        self.patches.get(&patch).and_then(|patch| patch.tiles[tile].as_deref()).map_or_else(Column::default, |tile| tile[at])
    }

    /// Sets the column of a cell of the world.
    fn set(&mut self, cell: [i64; 2], column: Column) {
        let Some((patch, tile, at)) = self.place(cell) else { return };
        let (revision, tiles) = (self.revision, self.tiles_across().pow(2));
        let empty = || SnowPatch { tiles: vec![None; tiles], count: 0, changed_in: revision, pressed_in: revision };
        let patch = self.patches.entry(patch).or_insert_with(empty);
        (patch.changed_in, patch.pressed_in) = (revision, revision);
        let tile = patch.tiles[tile].get_or_insert_with(|| {
            patch.count += 1;
            Box::new([Column::default(); CELLS])
        });
        tile[at] = column.minus(self.undisturbed);
        self.highest = self.highest.max(column.depth);
    }

    /// Patch of a cell of the world, its tile in the patch, and its place in the tile; `None` outside the world.
    fn place(&self, cell: [i64; 2]) -> Option<(PatchIndex, usize, usize)> {
        let cells = i64::from(self.layout.cells);
        let patch = self.layout.index(cell[0].div_euclid(cells), cell[1].div_euclid(cells))?;
        let [i, j] = cell.map(|at| at.rem_euclid(cells) as usize);
        Some((patch, j / TILE * self.tiles_across() + i / TILE, j % TILE * TILE + i % TILE))
    }

    fn tiles_across(&self) -> usize {
        self.layout.cells as usize / TILE
    }
}

impl SnowPatch {
    /// Lets a second's drift even out the differences, and drops tiles without any.
    fn decay(&mut self, decay: i64) {
        // At least one quantum, so that every difference ends.
        let less = |value: i64| value - value.signum() * scaled(value.abs(), decay, DECAY_UNIT).max(1);
        for tile in &mut self.tiles {
            let Some(cells) = tile else { continue };
            for cell in cells.iter_mut() {
                *cell = Column { mass: less(cell.mass), depth: less(cell.depth) };
            }
            if cells.iter().all(|cell| *cell == Column::default()) {
                *tile = None;
                self.count -= 1;
            }
        }
    }
}

#[cfg(test)]
mod tests;
