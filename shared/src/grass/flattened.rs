//! Flattened grass: the plastic part of the bend below the weight of objects, which recovers with its own time constant.
//!
//! Flattened grass needs no stepping. Its lean decays as `exp(−t/τ)` from the time when its tile was written, and is evaluated on reading.
//! Tiles, those of activity in [`crate::bend`], exist only where grass is flattened, in awake and in sleeping patches.

use super::camera::{Camera, nearest_distance2_m2};
use super::causes::Limits;
use crate::bend::TILE;
use crate::grid::{PatchIndex, PatchLayout};
use std::collections::BTreeMap;
use std::f32::consts::PI;

mod checkpoint;
mod patch;

pub use checkpoint::FlattenedState;
pub use patch::DetachedPatch;
use patch::{FlattenedPatch, FlattenedTile};

/// Memory of a tile, with its entry in the list (bytes).
pub const TILE_BYTES: usize = size_of::<FlattenedTile>() + size_of::<Option<Box<FlattenedTile>>>();
/// Quantum of a lean (rad). Leans are rounded towards zero to whole quanta, so that they decay to zero in finite time.
pub const QUANTUM_RAD: f32 = PI / i16::MAX as f32;
/// A tile is dropped when all its leans are below this (rad), 0.7°: it is no longer visible.
pub const VISIBLE_RAD: f32 = PI / 254.0;
/// Remaining fraction below which a decayed tile is rewritten before a new lean is stored, so that the lean is within the range of its quanta.
const REWRITE_FRACTION: f32 = 0.5;

/// Current time, and decay of leans with time.
#[derive(Clone, Copy, Debug)]
struct Clock {
    now_secs: f64,
    recovery_secs: f64,
}

impl Clock {
    fn remaining(&self, since_secs: f64) -> f32 {
        libm::exp((since_secs - self.now_secs) / self.recovery_secs) as f32
    }
}

/// The flattened grass of a world.
#[derive(Clone, Debug)]
pub struct FlattenedGrass {
    layout: PatchLayout,
    clock: Clock,
    tile_limit: usize,
    /// Number of completed steps.
    revision: u64,
    patches: BTreeMap<PatchIndex, FlattenedPatch>,
    dropped: u64,
}

impl FlattenedGrass {
    /// No flattened grass. Leans decay to 1/e in `recovery_secs`. At most `tile_limit` tiles are kept after each step.
    pub fn new(layout: PatchLayout, recovery_secs: f32, tile_limit: usize) -> Self {
        let clock = Clock { now_secs: 0.0, recovery_secs: recovery_secs.into() };
        Self { layout, clock, tile_limit, revision: 0, patches: BTreeMap::new(), dropped: 0 }
    }

    /// Simulated time (s) since the grass was at rest.
    pub fn secs(&self) -> f64 {
        self.clock.now_secs
    }

    /// Time (s) in which a lean (rad) recovers by `by_rad`; infinite for one that is not longer.
    pub fn recovery_secs(&self, lean_rad: f32, by_rad: f32) -> f64 {
        if lean_rad > by_rad { self.clock.recovery_secs * -libm::log1p(f64::from(-by_rad / lean_rad)) } else { f64::INFINITY }
    }

    /// Number of tiles, [`TILE_BYTES`] each.
    pub fn tiles(&self) -> usize {
        self.patches.values().map(|patch| patch.count).sum()
    }

    /// Number of patches so far whose flattened grass was dropped because of the limit.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }

    /// Patches with flattened grass, ascending.
    pub fn patches(&self) -> impl Iterator<Item = PatchIndex> {
        self.patches.keys().copied()
    }

    /// Lean of cell `(i, j)` of a patch (rad, as a vector along X and Z); zero where no grass is flattened. The error of each axis is at most two
    /// [quanta](QUANTUM_RAD).
    pub fn lean_rad(&self, patch: PatchIndex, i: usize, j: usize) -> [f32; 2] {
        let tile = self.patches.get(&patch).and_then(|patch| patch.tiles[self.tile_at(i, j)].as_deref());
        tile.map_or([0.0; 2], |tile| tile.leans[cell_at(i, j)].map(|units| units_rad(units) * self.clock.remaining(tile.since_secs)))
    }

    /// The flattened cells `(i, j)` of a patch, with their leans (rad).
    pub fn cells(&self, patch: PatchIndex) -> impl Iterator<Item = ([usize; 2], [f32; 2])> {
        let across = self.tiles_across();
        let tiles = self.patches.get(&patch).into_iter().flat_map(|patch| patch.tiles.iter().enumerate());
        tiles.filter_map(|(at, tile)| Some((at, tile.as_deref()?))).flat_map(move |(at, tile)| {
            let (west, north) = (at % across * TILE, at / across * TILE);
            let remaining = self.clock.remaining(tile.since_secs);
            let leans = tile.leans.iter().enumerate().filter(|(_, lean)| **lean != [0; 2]);
            leans.map(move |(cell, lean)| ([west + cell % TILE, north + cell / TILE], lean.map(|units| units_rad(units) * remaining)))
        })
    }

    /// Takes the flattened grass of a patch out of the world's, so that patches can be pressed in parallel; [`attach`](Self::attach) puts it back.
    pub(super) fn detach(&mut self, patch: PatchIndex) -> DetachedPatch {
        DetachedPatch::new(self.patches.remove(&patch), self.clock, self.tiles_across(), self.revision)
    }

    /// Puts back the flattened grass of a patch.
    pub(super) fn attach(&mut self, index: PatchIndex, patch: DetachedPatch) {
        self.patches.extend(patch.into_patch().map(|patch| (index, patch)));
    }

    /// Advances time by `dt_secs`. Each patch drops its invisible tiles about once a second, a few patches per step. Above the limit, the patches
    /// farthest from any camera lose their tiles first (farthest from the centre of the world when there is no camera); returns these.
    pub fn step(&mut self, dt_secs: f32, cameras: &[Camera]) -> Vec<PatchIndex> {
        self.step_within(dt_secs, Limits::Farthest(cameras))
    }

    /// [`step`](Self::step), with any choice of what is dropped above the limit.
    pub(super) fn step_within(&mut self, dt_secs: f32, limits: Limits) -> Vec<PatchIndex> {
        self.clock.now_secs += f64::from(dt_secs);
        let round = (1.0 / dt_secs).round().max(1.0) as u64;
        let (clock, revision) = (self.clock, self.revision);
        self.revision = self.revision.wrapping_add(1);
        self.patches.retain(|&index, patch| {
            if self.revision.wrapping_add(index.into()).is_multiple_of(round) {
                let count = patch.count;
                patch.drop_invisible(&clock);
                if patch.count < count {
                    patch.changed_in = revision;
                }
            }
            patch.count > 0
        });
        let dropped = match limits {
            Limits::Farthest(cameras) => self.farthest(cameras),
            Limits::Given { dropped, .. } => dropped.to_vec(),
        };
        for patch in &dropped {
            self.dropped = self.dropped.wrapping_add(self.patches.remove(patch).is_some().into());
        }
        dropped
    }

    /// The patches farthest from any camera that hold the tiles above the limit, farthest first.
    fn farthest(&self, cameras: &[Camera]) -> Vec<PatchIndex> {
        let mut tiles = self.tiles();
        if tiles <= self.tile_limit {
            return vec![];
        }
        let distance2_m2 = |patch: &PatchIndex| nearest_distance2_m2(*patch, &self.layout, cameras);
        let mut farthest: Vec<PatchIndex> = self.patches().collect();
        farthest.sort_by(|a, b| distance2_m2(b).total_cmp(&distance2_m2(a)).then(b.cmp(a)));
        let mut is_above = |patch: &PatchIndex| {
            let above = tiles > self.tile_limit;
            tiles -= self.patches.get(patch).map_or(0, |patch| patch.count);
            above
        };
        farthest.retain(|patch| is_above(patch));
        farthest
    }

    /// Number of completed steps. Pass it to [`changed_since`](Self::changed_since) later to find the patches that have changed.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Whether the flattened grass of a patch may have changed since this [revision](Self::revision).
    pub fn changed_since(&self, revision: u64, patch: PatchIndex) -> bool {
        self.patches.get(&patch).is_some_and(|patch| patch.changed_in >= revision)
    }

    /// The whole state as words, for hashing: patch, age and leans of each tile.
    pub fn words(&self) -> impl Iterator<Item = u32> {
        self.patches.keys().flat_map(|index| self.words_of(*index))
    }

    /// The [words](Self::words) of one patch.
    pub fn words_of(&self, index: PatchIndex) -> impl Iterator<Item = u32> {
        let tiles = self.patches.get(&index).into_iter().flat_map(|patch| patch.tiles.iter().flatten());
        tiles.flat_map(move |tile| {
            let age = (self.clock.now_secs - tile.since_secs).to_bits();
            let leans = tile.leans.iter().map(|&[x, z]| u32::from(x.cast_unsigned()) << 16 | u32::from(z.cast_unsigned()));
            [index, (age >> 32) as u32, age as u32].into_iter().chain(leans)
        })
    }

    fn tiles_across(&self) -> usize {
        self.layout.cells as usize / TILE
    }

    fn tile_at(&self, i: usize, j: usize) -> usize {
        j / TILE * self.tiles_across() + i / TILE
    }
}

fn cell_at(i: usize, j: usize) -> usize {
    j % TILE * TILE + i % TILE
}

fn units_rad(units: i16) -> f32 {
    f32::from(units) * QUANTUM_RAD
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const LAYOUT: PatchLayout = PatchLayout { count: [20, 20], cells: 16, cell_m: 0.5 };
    const DT_SECS: f32 = 1.0 / 60.0;

    fn flatten(grass: &mut FlattenedGrass, index: PatchIndex, [i, j]: [usize; 2], lean_rad: [f32; 2]) -> [f32; 2] {
        let mut patch = grass.detach(index);
        let kept = patch.flatten(i, j, lean_rad);
        grass.attach(index, patch);
        kept
    }

    fn run(grass: &mut FlattenedGrass, secs: f32) {
        for _ in 0..(secs / DT_SECS).round() as u32 {
            grass.step(DT_SECS, &[]);
        }
    }

    #[test]
    fn leans_decay_exponentially_within_two_quanta() {
        let mut grass = FlattenedGrass::new(LAYOUT, 20.0, 1000);
        let kept = flatten(&mut grass, 3, [9, 2], [1.1, -0.4]);
        assert!((kept[0] - 1.1).abs() < QUANTUM_RAD && (kept[1] + 0.4).abs() < QUANTUM_RAD);
        for second in 1..=60 {
            run(&mut grass, 1.0);
            // Rewriting neighbours costs the first cell no accuracy.
            flatten(&mut grass, 3, [10, 2], [0.5, 0.5]);
            let remaining = (-f64::from(second) / 20.0).exp() as f32;
            let found = grass.lean_rad(3, 9, 2);
            for (axis, first) in [1.1, -0.4].into_iter().enumerate() {
                let off = (found[axis] - first * remaining).abs();
                assert!(off < 2.0 * QUANTUM_RAD, "after {second} s: {found:?}, off by {} quanta", off / QUANTUM_RAD);
            }
        }
        assert_eq!((grass.lean_rad(3, 9, 3), grass.lean_rad(4, 9, 2)), ([0.0; 2], [0.0; 2]));
        assert_eq!(grass.cells(3).map(|(cell, _)| cell).collect::<Vec<_>>(), [[9, 2], [10, 2]]);
    }

    #[test]
    fn tiles_end_when_they_are_no_longer_visible() {
        let mut grass = FlattenedGrass::new(LAYOUT, 2.0, 1000);
        flatten(&mut grass, 3, [0, 0], [1.0, 0.0]);
        flatten(&mut grass, 3, [8, 0], [0.1, 0.0]);
        let ends_secs = 2.0 * (0.1 / VISIBLE_RAD).ln();
        run(&mut grass, ends_secs - 0.1);
        assert_eq!(grass.tiles(), 2);
        run(&mut grass, 1.2);
        assert_eq!(grass.tiles(), 1, "the faint one is dropped within a second of its end");
        run(&mut grass, 10.0);
        assert_eq!((grass.tiles(), grass.patches().count(), grass.dropped()), (0, 0, 0));
    }

    #[test]
    fn memory_is_bounded_and_the_farthest_from_any_camera_are_dropped_first() {
        let mut grass = FlattenedGrass::new(LAYOUT, 60.0, 50);
        let cameras = [[10.0, 10.0], [150.0, 150.0]].map(|[x, z]| Camera { client: 0, eye_m: [x, 2.0, z] });
        for index in 0..400 {
            flatten(&mut grass, index, [4, 4], [1.0, 0.0]);
            flatten(&mut grass, index, [12, 4], [1.0, 0.0]);
            grass.step(DT_SECS, &cameras);
            assert!(grass.tiles() <= 50);
        }
        assert_eq!(grass.dropped(), 375);
        let kept_m2 = grass.patches().map(|index| nearest_distance2_m2(index, &LAYOUT, &cameras)).fold(0.0, f32::max);
        assert!(kept_m2 < 40.0 * 40.0, "the farthest that is kept is {} m away", kept_m2.sqrt());
    }

    #[test]
    fn a_lean_just_below_a_quantum_is_rounded_down_although_its_quotient_rounds_up() {
        let short = [0.826_745, -0.922_142_3];
        assert_eq!(short.map(|rad: f32| (rad / QUANTUM_RAD).fract()), [0.0; 2]);
        let kept = flatten(&mut FlattenedGrass::new(LAYOUT, 30.0, 1000), 0, [2, 1], short);
        for (kept, lean) in kept.into_iter().zip(short) {
            assert!(kept.abs() < lean.abs() && (kept - lean).abs() <= QUANTUM_RAD, "{kept} of {lean}");
        }
    }

    proptest! {
        #[test]
        fn any_lean_is_stored_within_a_quantum(x in -1.57f32..1.57, z in -1.57f32..1.57, secs in 0.0f32..40.0) {
            let mut grass = FlattenedGrass::new(LAYOUT, 30.0, 1000);
            flatten(&mut grass, 0, [1, 1], [0.7, 0.7]);
            run(&mut grass, secs);
            let kept = flatten(&mut grass, 0, [2, 1], [x, z]);
            prop_assert_eq!(kept, grass.lean_rad(0, 2, 1));
            prop_assert!((kept[0] - x).abs() <= QUANTUM_RAD && (kept[1] - z).abs() <= QUANTUM_RAD);
            prop_assert!(kept[0].abs() <= x.abs() && kept[1].abs() <= z.abs(), "rounded towards zero");
        }
    }
}
