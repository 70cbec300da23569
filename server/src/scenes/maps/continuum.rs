//! Maps of `continuum`: rolling prairie with draws, a shallow valley with a creek, and stands of three grasses.

use super::grey_map::{GreyMap, Levels};
use super::landforms::{Noise, Point, scatter, smooth_step};
use prairie_core::random::SplitMix64;

/// Side of the world of Chen & Johan: 88 patches of 120 cells of 1.5 feet (m).
const EXTENT_M: f64 = 88.0 * 120.0 * 0.4572;

/// Height map: pixels per side, the last one on the far edge; spacing (m); metres per grey level.
const HEIGHT_PX: u32 = 1025;
const PIXEL_M: f64 = EXTENT_M / (HEIGHT_PX - 1) as f64;
const LEVEL_M: f64 = 0.01;

/// Covering map: pixels per side.
const COVER_PX: u32 = 2048;

/// Covering IDs of the scene's species.
const BUFFALO_GRASS: u8 = 1;
const BLUESTEM: u8 = 2;
const CORDGRASS: u8 = 3;

const TREES: usize = 420;
const STONES: usize = 260;

/// Elevation of the creek at the western edge, and its fall towards the east (m).
const SPRING_M: f64 = 24.0;
const FALL_M: f64 = 12.0;

/// Height map and covering map.
pub(super) fn maps() -> [GreyMap; 2] {
    let land = Continuum::new();
    let heights = pixels(HEIGHT_PX, PIXEL_M, 0.0).map(|at| (land.height_m(at) / LEVEL_M).round().clamp(0.0, 65_535.0) as u16);
    let height = GreyMap { name: "continuum-height.png", size_px: [HEIGHT_PX; 2], levels: Levels::Sixteen(heights.collect()) };
    [height, land.covering()]
}

/// Positions of a square map's pixels, row by row; `offset` is that of the first, in pixels.
fn pixels(side_px: u32, pixel_m: f64, offset: f64) -> impl Iterator<Item = Point> {
    (0..side_px).flat_map(move |row| (0..side_px).map(move |column| [column, row].map(|i| (f64::from(i) + offset) * pixel_m)))
}

struct Continuum {
    course: Noise,
    meander: Noise,
    swell: Noise,
    roll: Noise,
    draws: Noise,
    rough: Noise,
    drift: Noise,
    groves: Noise,
    wear: Noise,
}

impl Continuum {
    fn new() -> Self {
        Self {
            course: Noise::smooth(31, 2300.0, 1, 0.5),
            meander: Noise::smooth(32, 430.0, 2, 0.4),
            swell: Noise::smooth(33, 1300.0, 1, 0.5),
            roll: Noise::smooth(34, 480.0, 2, 0.35),
            draws: Noise::smooth(35, 900.0, 2, 0.3),
            rough: Noise::smooth(36, 60.0, 2, 0.5),
            drift: Noise::smooth(37, 260.0, 5, 0.6),
            groves: Noise::smooth(38, 130.0, 2, 0.5),
            wear: Noise::smooth(39, 46.0, 3, 0.6),
        }
    }

    /// Z of the valley's centre line at an X (m).
    fn valley_z_m(&self, x: f64) -> f64 {
        0.56 * EXTENT_M + 900.0 * self.course.at([x, 900.0])
    }

    /// Z of the creek at an X (m); it meanders within the valley.
    fn creek_z_m(&self, x: f64) -> f64 {
        self.valley_z_m(x) + 190.0 * self.meander.at([x, 150.0])
    }

    fn creek_distance_m(&self, at: Point) -> f64 {
        distance_from(|x| self.creek_z_m(x), at)
    }

    /// Weight of the upland: 0 on the valley floor, 1 above its slopes.
    fn upland(&self, at: Point) -> f64 {
        smooth_step(50.0, 560.0, distance_from(|x| self.valley_z_m(x), at))
    }

    /// Depth within a draw: 0 outside, 1 at the bottom.
    fn draw(&self, at: Point) -> f64 {
        1.0 - smooth_step(0.0, 0.3, self.draws.at(at).abs())
    }

    fn swell_m(&self, at: Point) -> f64 {
        25.0 + 24.0 * self.swell.at(at) + 10.0 * self.roll.at(at)
    }

    fn height_m(&self, at: Point) -> f64 {
        let creek_m = SPRING_M - FALL_M * at[0] / EXTENT_M;
        let upland = self.upland(at);
        let channel_m = 1.5 * (1.0 - smooth_step(2.0, 15.0, self.creek_distance_m(at)));
        creek_m + upland * (self.swell_m(at) - 5.0 * self.draw(at)) + (0.3 + 0.3 * upland) * self.rough.at(at) - channel_m
    }

    fn covering(&self) -> GreyMap {
        let pixel_m = EXTENT_M / f64::from(COVER_PX);
        let mut levels: Vec<u8> = pixels(COVER_PX, pixel_m, 0.5).map(|at| self.grass(at)).collect();
        let mut put = |id: u8, places: Vec<Point>| {
            for [x, z] in places {
                levels[(z / pixel_m) as usize * COVER_PX as usize + (x / pixel_m) as usize] = id;
            }
        };
        let mut random = SplitMix64::new(2012);
        put(253, scatter(&mut random, [EXTENT_M; 2], TREES, 7.0, |at| self.tree_chance(at)));
        put(254, scatter(&mut random, [EXTENT_M; 2], STONES, 12.0, |at| self.stone_chance(at)));
        GreyMap { name: "continuum-covering.png", size_px: [COVER_PX; 2], levels: Levels::Eight(levels) }
    }

    /// Covering ID at a position: cordgrass along the creek, bluestem in wet hollows, buffalo grass on dry swells, a mixture between; the creek bed and a
    /// few worn patches are bare.
    fn grass(&self, at: Point) -> u8 {
        let (drift, wear) = (self.drift.at(at), self.wear.at(at));
        let creek_distance_m = self.creek_distance_m(at);
        if creek_distance_m < 2.6 + 1.2 * wear {
            return 0;
        }
        if creek_distance_m < 20.0 + 26.0 * drift {
            return CORDGRASS;
        }
        let upland = self.upland(at);
        let dry = upland * (0.03 * (self.swell_m(at) - 25.0) - 0.35 * self.draw(at)) - 0.4 * (1.0 - upland) + 1.7 * drift;
        match dry {
            dry if dry > 0.2 && wear > 0.66 => 0,
            dry if dry > 0.2 => BUFFALO_GRASS,
            dry if dry < -0.33 => BLUESTEM,
            _ => 255,
        }
    }

    /// Groves beside the creek, and a few single trees in the draws.
    fn tree_chance(&self, at: Point) -> f64 {
        let creek_distance_m = self.creek_distance_m(at);
        let bank = smooth_step(7.0, 12.0, creek_distance_m) * (1.0 - smooth_step(30.0, 75.0, creek_distance_m));
        let grove = smooth_step(0.05, 0.4, self.groves.at(at));
        bank * (0.04 + grove) + 0.0006 * smooth_step(0.5, 0.9, self.draw(at))
    }

    /// Outcrops on the highest swells.
    fn stone_chance(&self, at: Point) -> f64 {
        let crest = smooth_step(29.0, 38.0, self.swell_m(at)) * self.upland(at);
        0.002 + crest * smooth_step(0.2, 0.5, self.wear.at(at))
    }
}

/// Distance of a point from the curve `z_m(x)` (m), to first order: perpendicular to the curve's slope at that X.
fn distance_from(z_m: impl Fn(f64) -> f64, [x, z]: Point) -> f64 {
    const STEP_M: f64 = 2.0;
    let here = z_m(x);
    let slope = (z_m(x + STEP_M) - here) / STEP_M;
    (z - here).abs() / (1.0 + slope * slope).sqrt()
}
