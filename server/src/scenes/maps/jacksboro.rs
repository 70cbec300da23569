//! Covering map of the real terrain of `jacksboro`: woods on steep and high ground, rocks on the steepest.

use super::grey_map::{GreyMap, Levels};
use super::landforms::{Noise, Point, scatter, smooth_step};
use crate::scenes::builtin;
use prairie_core::random::SplitMix64;
use prairie_core::terrain::HeightMap;

/// Covering map: pixels per side.
const COVER_PX: u32 = 2048;

const TREES: usize = 24_000;
const STONES: usize = 3000;

/// Covering map for the stored elevations.
pub(super) fn covering() -> GreyMap {
    let (height, extent_m) = builtin::jacksboro_terrain();
    let extent_m = extent_m.map(f64::from);
    let terrain = Jacksboro { height, groves: Noise::new(21, 1400.0, 4, 0.55), wear: Noise::new(22, 420.0, 3, 0.6) };
    let pixel_m = extent_m.map(|side| side / f64::from(COVER_PX));
    let index = |[x, z]: Point| (z / pixel_m[1]) as usize * COVER_PX as usize + (x / pixel_m[0]) as usize;

    let mut levels = vec![255; (COVER_PX * COVER_PX) as usize];
    for row in 0..COVER_PX {
        for column in 0..COVER_PX {
            let at = [(f64::from(column) + 0.5) * pixel_m[0], (f64::from(row) + 0.5) * pixel_m[1]];
            if terrain.is_bare(at) {
                levels[index(at)] = 0;
            }
        }
    }
    let mut random = SplitMix64::new(1963);
    for (id, count, apart_m) in [(253, TREES, 40.0), (254, STONES, 60.0)] {
        let chance = |at| if id == 253 { terrain.tree_chance(at) } else { terrain.stone_chance(at) };
        for at in scatter(&mut random, extent_m, count, apart_m, chance) {
            levels[index(at)] = id;
        }
    }
    GreyMap { name: "jacksboro-covering.png", size_px: [COVER_PX; 2], levels: Levels::Eight(levels) }
}

struct Jacksboro {
    height: HeightMap,
    groves: Noise,
    wear: Noise,
}

impl Jacksboro {
    fn steepness(&self, at: Point) -> f64 {
        let [east, south] = self.height.slope(at[0] as f32, at[1] as f32).map(f64::from);
        (east * east + south * south).sqrt()
    }

    fn elevation_m(&self, at: Point) -> f64 {
        self.height.height_m(at[0] as f32, at[1] as f32).into()
    }

    /// Rock faces and worn ground.
    fn is_bare(&self, at: Point) -> bool {
        self.steepness(at) > 0.62 + 0.5 * self.wear.at(at) || self.wear.at(at) > 0.62
    }

    fn tree_chance(&self, at: Point) -> f64 {
        let steep = smooth_step(0.10, 0.35, self.steepness(at));
        let high = smooth_step(420.0, 720.0, self.elevation_m(at));
        let grove = smooth_step(-0.15, 0.35, self.groves.at(at));
        (0.04 + 0.96 * (0.6 * steep + 0.4 * high)) * (0.1 + 0.9 * grove)
    }

    fn stone_chance(&self, at: Point) -> f64 {
        0.01 + smooth_step(0.35, 0.7, self.steepness(at))
    }
}
