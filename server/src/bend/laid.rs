//! Grass that stays bent below the weight of objects: the plastic part of the bend, which rises with a time constant of its own.
//!
//! Laid grass lies still, so it costs no step: a lean fades by `exp(−t/τ)` from the moment that its tile was written, worked out when it
//! is read. Tiles of 8 × 8 cells exist only where grass is laid, whether the field's patch there is awake or not.

use super::View;
use super::contact::length;
use shared::grid::{PatchIndex, PatchLayout};
use shared::wire::quantise::THETA_FULL_RAD;
use std::collections::BTreeMap;
use std::f32::consts::PI;

/// Cells along one side of a tile.
pub const TILE: usize = 8;
/// Memory of a tile, with its place in the list.
pub const TILE_BYTES: usize = size_of::<Tile>() + size_of::<Option<Box<Tile>>>();
/// Lean of one unit (rad). Leans are cut towards zero to whole units, so that they end.
pub const QUANTUM_RAD: f32 = PI / i16::MAX as f32;
/// A tile whose leans are all below this is let go (rad): half a code on the wire, so that it shows no more.
pub const LEAST_RAD: f32 = THETA_FULL_RAD / 254.0;
/// A tile that has faded to this share is written anew before it takes another lean, so that the new one fits into its units.
const RENEW_SHARE: f32 = 0.5;

/// Where the time is, and how leans fade with it.
#[derive(Clone, Copy, Debug)]
struct Clock {
    now_secs: f64,
    recovery_secs: f64,
}

impl Clock {
    fn share_left(&self, since_secs: f64) -> f32 {
        ((since_secs - self.now_secs) / self.recovery_secs).exp() as f32
    }
}

/// The laid grass of a world.
#[derive(Clone, Debug)]
pub struct Laid {
    layout: PatchLayout,
    clock: Clock,
    tile_limit: usize,
    tick: u64,
    patches: BTreeMap<PatchIndex, LaidPatch>,
    dropped: u64,
}

/// The laid grass of one patch.
#[derive(Clone, Debug)]
struct LaidPatch {
    /// Row by row from the north-west.
    tiles: Vec<Option<Box<Tile>>>,
    count: usize,
    /// Whether it looks other than when it was shown last.
    changed: bool,
}

/// Leans along X and Z in units, as they were `since_secs`.
#[derive(Clone, Debug)]
struct Tile {
    since_secs: f64,
    leans: [[i16; 2]; TILE * TILE],
}

impl Laid {
    /// Nothing laid yet. What is laid falls to 1/e in `recovery_secs`. After each step at most `tile_limit` tiles are kept.
    pub fn new(layout: PatchLayout, recovery_secs: f32, tile_limit: usize) -> Self {
        let clock = Clock { now_secs: 0.0, recovery_secs: recovery_secs.into() };
        Self { layout, clock, tile_limit, tick: 0, patches: BTreeMap::new(), dropped: 0 }
    }

    /// Number of tiles, [`TILE_BYTES`] each.
    pub fn tiles(&self) -> usize {
        self.patches.values().map(|patch| patch.count).sum()
    }

    /// Patches whose laid grass was let go so far because there was too much.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }

    /// Patches with laid grass, ascending.
    pub fn patches(&self) -> impl Iterator<Item = PatchIndex> {
        self.patches.keys().copied()
    }

    /// Lean of cell `(i, j)` of a patch (rad, as a vector along X and Z); none where nothing is laid. Off the exact course by at most
    /// two [quanta](QUANTUM_RAD) an axis.
    pub fn lean_rad(&self, patch: PatchIndex, i: usize, j: usize) -> [f32; 2] {
        let tile = self.patches.get(&patch).and_then(|patch| patch.tiles[self.tile_at(i, j)].as_deref());
        tile.map_or([0.0; 2], |tile| tile.leans[cell_at(i, j)].map(|units| units_rad(units) * self.clock.share_left(tile.since_secs)))
    }

    /// The cells `(i, j)` of a patch that are laid, with their leans (rad).
    pub fn cells(&self, patch: PatchIndex) -> impl Iterator<Item = ([usize; 2], [f32; 2])> {
        let across = self.tiles_across();
        let tiles = self.patches.get(&patch).into_iter().flat_map(|patch| patch.tiles.iter().enumerate());
        tiles.filter_map(|(at, tile)| Some((at, tile.as_deref()?))).flat_map(move |(at, tile)| {
            let (west, north) = (at % across * TILE, at / across * TILE);
            let share = self.clock.share_left(tile.since_secs);
            let laid = tile.leans.iter().enumerate().filter(|(_, lean)| **lean != [0; 2]);
            laid.map(move |(cell, lean)| ([west + cell % TILE, north + cell / TILE], lean.map(|units| units_rad(units) * share)))
        })
    }

    /// Lays cell `(i, j)` of a patch with a lean of at most a right angle (rad); returns what is kept of it.
    pub fn lay(&mut self, patch: PatchIndex, i: usize, j: usize, lean_rad: [f32; 2]) -> [f32; 2] {
        let (clock, at, across) = (self.clock, self.tile_at(i, j), self.tiles_across());
        let empty = || LaidPatch { tiles: vec![None; across * across], count: 0, changed: true };
        let patch = self.patches.entry(patch).or_insert_with(empty);
        patch.changed = true;
        let tile = patch.tiles[at].get_or_insert_with(|| {
            patch.count += 1;
            Box::new(Tile { since_secs: clock.now_secs, leans: [[0; 2]; TILE * TILE] })
        });
        let mut share = clock.share_left(tile.since_secs);
        if share < RENEW_SHARE {
            tile.leans.iter_mut().flatten().for_each(|units| *units = (f32::from(*units) * share) as i16);
            (tile.since_secs, share) = (clock.now_secs, 1.0);
        }
        let units = lean_rad.map(|rad| {
            let cut = (rad / (share * QUANTUM_RAD)) as i16;
            // The quotient of a lean just short of a unit may round up to it.
            if (units_rad(cut) * share).abs() > rad.abs() { cut - cut.signum() } else { cut }
        });
        tile.leans[cell_at(i, j)] = units;
        units.map(|units| units_rad(units) * share)
    }

    /// Time goes on by `dt_secs`. About once a second each patch, some of them every tick, lets go of tiles that show no more. While there
    /// are too many, the patch farthest from any camera (from the world's middle where there is none) loses its own.
    pub fn step(&mut self, dt_secs: f32, views: &[View]) {
        self.clock.now_secs += f64::from(dt_secs);
        self.tick += 1;
        let round = (1.0 / dt_secs).round().max(1.0) as u64;
        let clock = self.clock;
        self.patches.retain(|&index, patch| {
            if (self.tick + u64::from(index)).is_multiple_of(round) {
                patch.tidy(&clock);
            }
            patch.count > 0
        });
        let mut tiles = self.tiles();
        while tiles > self.tile_limit {
            let farthest = self.patches.iter().max_by(|a, b| self.distance2_m2(*a.0, views).total_cmp(&self.distance2_m2(*b.0, views)));
            let Some(index) = farthest.map(|(&index, _)| index) else { break };
            tiles -= self.patches.remove(&index).map_or(0, |patch| patch.count);
            self.dropped += 1;
        }
    }

    /// Whether a patch looks other than when it was [shown](Self::was_shown) last.
    pub fn changed(&self, patch: PatchIndex) -> bool {
        self.patches.get(&patch).is_some_and(|patch| patch.changed)
    }

    /// Takes note that a patch was shown.
    pub fn was_shown(&mut self, patch: PatchIndex) {
        if let Some(patch) = self.patches.get_mut(&patch) {
            patch.changed = false;
        }
    }

    /// Everything that tells how the grass lies: place, age bits and leans of each tile.
    pub fn words(&self) -> impl Iterator<Item = u32> {
        let tiles = self.patches.iter().flat_map(|(&index, patch)| patch.tiles.iter().flatten().map(move |tile| (index, tile)));
        tiles.flat_map(|(index, tile)| {
            let age = (self.clock.now_secs - tile.since_secs).to_bits();
            let leans = tile.leans.iter().map(|&[x, z]| u32::from(x.cast_unsigned()) << 16 | u32::from(z.cast_unsigned()));
            [index, (age >> 32) as u32, age as u32].into_iter().chain(leans)
        })
    }

    /// Square of the distance of a patch's middle from the nearest camera (m²).
    fn distance2_m2(&self, patch: PatchIndex, views: &[View]) -> f32 {
        let center = self.layout.center_m(patch);
        let from = |[x, z]: [f32; 2]| (center[0] - x) * (center[0] - x) + (center[1] - z) * (center[1] - z);
        let nearest = views.iter().map(|view| from([view.eye_m[0], view.eye_m[2]])).reduce(f32::min);
        nearest.unwrap_or_else(|| from(self.layout.extent_m().map(|extent| 0.5 * extent)))
    }

    fn tiles_across(&self) -> usize {
        self.layout.cells as usize / TILE
    }

    fn tile_at(&self, i: usize, j: usize) -> usize {
        j / TILE * self.tiles_across() + i / TILE
    }
}

impl LaidPatch {
    /// Lets go of tiles that show no more.
    fn tidy(&mut self, clock: &Clock) {
        for tile in &mut self.tiles {
            if tile.as_ref().is_some_and(|tile| tile.largest_rad() * clock.share_left(tile.since_secs) < LEAST_RAD) {
                *tile = None;
                self.count -= 1;
            }
        }
        self.changed = true;
    }
}

impl Tile {
    /// Largest lean as it was written (rad).
    fn largest_rad(&self) -> f32 {
        self.leans.iter().map(|&lean| length(lean.map(units_rad))).fold(0.0, f32::max)
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

    fn run(laid: &mut Laid, secs: f32) {
        (0..(secs / DT_SECS).round() as u32).for_each(|_| laid.step(DT_SECS, &[]));
    }

    #[test]
    fn leans_fade_by_the_exponential_within_two_quanta() {
        let mut laid = Laid::new(LAYOUT, 20.0, 1000);
        let kept = laid.lay(3, 9, 2, [1.1, -0.4]);
        assert!((kept[0] - 1.1).abs() < QUANTUM_RAD && (kept[1] + 0.4).abs() < QUANTUM_RAD);
        for second in 1..=60 {
            run(&mut laid, 1.0);
            // Neighbours that are laid again and again cost the first no accuracy.
            laid.lay(3, 10, 2, [0.5, 0.5]);
            let share = (-f64::from(second) / 20.0).exp() as f32;
            let found = laid.lean_rad(3, 9, 2);
            for (axis, first) in [1.1, -0.4].into_iter().enumerate() {
                let off = (found[axis] - first * share).abs();
                assert!(off < 2.0 * QUANTUM_RAD, "after {second} s: {found:?}, off by {} quanta", off / QUANTUM_RAD);
            }
        }
        assert_eq!((laid.lean_rad(3, 9, 3), laid.lean_rad(4, 9, 2)), ([0.0; 2], [0.0; 2]));
        assert_eq!(laid.cells(3).map(|(cell, _)| cell).collect::<Vec<_>>(), [[9, 2], [10, 2]]);
    }

    #[test]
    fn tiles_end_when_they_show_no_more() {
        let mut laid = Laid::new(LAYOUT, 2.0, 1000);
        laid.lay(3, 0, 0, [1.0, 0.0]);
        laid.lay(3, 8, 0, [0.1, 0.0]);
        let ends_secs = 2.0 * (0.1 / LEAST_RAD).ln();
        run(&mut laid, ends_secs - 0.1);
        assert_eq!(laid.tiles(), 2);
        run(&mut laid, 1.2);
        assert_eq!(laid.tiles(), 1, "the faint one goes within a second of its end");
        run(&mut laid, 10.0);
        assert_eq!((laid.tiles(), laid.patches().count(), laid.dropped()), (0, 0, 0));
    }

    #[test]
    fn memory_is_bounded_and_the_farthest_from_any_camera_go_first() {
        let mut laid = Laid::new(LAYOUT, 60.0, 50);
        let views = [[10.0, 10.0], [150.0, 150.0]].map(|[x, z]| View { client: 0, eye_m: [x, 2.0, z] });
        for index in 0..400 {
            laid.lay(index, 4, 4, [1.0, 0.0]);
            laid.lay(index, 12, 4, [1.0, 0.0]);
            laid.step(DT_SECS, &views);
            assert!(laid.tiles() <= 50);
        }
        assert_eq!(laid.dropped(), 375);
        let kept_m2 = laid.patches().map(|index| laid.distance2_m2(index, &views)).fold(0.0, f32::max);
        assert!(kept_m2 < 40.0 * 40.0, "the farthest that is kept lies {} m off", kept_m2.sqrt());
    }

    #[test]
    fn a_lean_just_short_of_a_unit_is_cut_although_its_quotient_rounds_up() {
        let short = [0.826_745, -0.922_142_3];
        assert_eq!(short.map(|rad: f32| (rad / QUANTUM_RAD).fract()), [0.0; 2]);
        let kept = Laid::new(LAYOUT, 30.0, 1000).lay(0, 2, 1, short);
        for (kept, lean) in kept.into_iter().zip(short) {
            assert!(kept.abs() < lean.abs() && (kept - lean).abs() <= QUANTUM_RAD, "{kept} of {lean}");
        }
    }

    proptest! {
        #[test]
        fn any_lean_is_kept_within_a_quantum(x in -1.57f32..1.57, z in -1.57f32..1.57, secs in 0.0f32..40.0) {
            let mut laid = Laid::new(LAYOUT, 30.0, 1000);
            laid.lay(0, 1, 1, [0.7, 0.7]);
            run(&mut laid, secs);
            let kept = laid.lay(0, 2, 1, [x, z]);
            prop_assert_eq!(kept, laid.lean_rad(0, 2, 1));
            prop_assert!((kept[0] - x).abs() <= QUANTUM_RAD && (kept[1] - z).abs() <= QUANTUM_RAD);
            prop_assert!(kept[0].abs() <= x.abs() && kept[1].abs() <= z.abs(), "cut towards zero");
        }
    }
}
