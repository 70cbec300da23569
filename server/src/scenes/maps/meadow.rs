//! Maps of `meadow`: a broad valley between knolls, with a trail, and ridges along the edges.

use super::grey_map::{GreyMap, Levels};
use super::landforms::{Noise, Point, Spline, bump, distance, scatter, smooth_step};
use prairie_core::random::SplitMix64;

const EXTENT_M: Point = [256.0, 256.0];

/// Height map: pixels per side, spacing (m), metres per grey level, elevation of level 0 (m).
const HEIGHT_PX: u32 = 129;
const PIXEL_M: f64 = 2.0;
const LEVEL_M: f64 = 0.1;
const BASE_M: f64 = -5.0;

/// Covering map: pixels per side, one per plant (Zhang, §5.5.1).
const COVER_PX: u32 = 512;

/// IDs of painted species of underbrush.
const REEDS: u8 = 20;
const POPPIES: u8 = 21;

const TREES: usize = 250;
const STONES: usize = 200;

/// Knolls: centre (m), radius (m), height (m).
const KNOLLS: [(Point, f64, f64); 7] = [
    ([62.0, 96.0], 20.0, 5.5),
    ([88.0, 70.0], 15.0, 3.5),
    ([196.0, 84.0], 24.0, 6.5),
    ([172.0, 116.0], 12.0, 2.2),
    ([206.0, 186.0], 18.0, 4.5),
    ([66.0, 192.0], 22.0, 5.0),
    ([118.0, 214.0], 14.0, 2.4),
];

/// Centre line of the valley, from the southern edge to a gap in the northern ridge.
const BED: [Point; 6] = [[96.0, 262.0], [104.0, 212.0], [134.0, 168.0], [120.0, 118.0], [136.0, 66.0], [150.0, -6.0]];

/// The trail, from the western edge across the valley to the northern gap.
const TRAIL: [Point; 8] =
    [[-6.0, 146.0], [40.0, 150.0], [84.0, 140.0], [118.0, 150.0], [148.0, 132.0], [144.0, 96.0], [158.0, 52.0], [146.0, -6.0]];

/// Range of the reeds along the valley (Z, m): ahead of the starting point in `meadow`, beside it in `underbrush`.
const MEADOW_REEDS_M: [f64; 2] = [70.0, 142.0];
const UNDERBRUSH_REEDS_M: [f64; 2] = [112.0, 192.0];

/// Height map, covering map, covering map with reeds, and covering map with reeds and poppies.
pub(super) fn maps() -> [GreyMap; 4] {
    let land = Meadow::new();
    let levels = pixels(HEIGHT_PX, PIXEL_M, 0.0).map(|at| ((land.height_m(at) - BASE_M) / LEVEL_M).round().clamp(0.0, 255.0) as u8);
    let height = GreyMap { name: "meadow-height.png", size_px: [HEIGHT_PX; 2], levels: Levels::Eight(levels.collect()) };
    let reeds = land.painted("meadow-reeds-covering.png", |at| land.is_wet(at, MEADOW_REEDS_M).then_some(REEDS));
    let underbrush = land.painted("underbrush-covering.png", |at| match at {
        at if land.is_wet(at, UNDERBRUSH_REEDS_M) => Some(REEDS),
        at if land.is_drift(at) => Some(POPPIES),
        _ => None,
    });
    [height, land.covering(), reeds, underbrush]
}

/// Positions of a square map's pixels, row by row; `offset` is that of the first, in pixels.
fn pixels(side_px: u32, pixel_m: f64, offset: f64) -> impl Iterator<Item = Point> {
    (0..side_px).flat_map(move |row| (0..side_px).map(move |column| [column, row].map(|i| (f64::from(i) + offset) * pixel_m)))
}

struct Meadow {
    bed: Spline,
    trail: Spline,
    swell: Noise,
    rough: Noise,
    groves: Noise,
    wear: Noise,
}

impl Meadow {
    fn new() -> Self {
        Self {
            bed: Spline::through(&BED),
            trail: Spline::through(&TRAIL),
            swell: Noise::new(11, 90.0, 2, 0.45),
            rough: Noise::new(12, 34.0, 3, 0.5),
            groves: Noise::new(13, 46.0, 2, 0.5),
            wear: Noise::new(14, 7.0, 3, 0.6),
        }
    }

    fn height_m(&self, at: Point) -> f64 {
        let from_bed = self.bed.distance(at);
        let valley = -2.6 * (1.0 - smooth_step(4.0, 48.0, from_bed));
        let knolls: f64 = KNOLLS.iter().map(|&(centre, radius, height)| height * bump(at, centre, radius)).sum();
        let open = smooth_step(10.0, 60.0, from_bed);
        let swell = 2.2 * self.swell.at(at) + (0.35 + 0.65 * open) * self.rough.at(at);
        valley + knolls + swell + self.ridge_m(at, from_bed)
    }

    /// Uneven ridges along the edges that close the view, with gaps at the ends of the valley.
    fn ridge_m(&self, at: Point, from_bed: f64) -> f64 {
        let shift = 9.0 * self.swell.at([at[0] + 300.0, at[1]]);
        let open = |axis: usize| smooth_step(2.0, 52.0, at[axis].min(EXTENT_M[axis] - at[axis]) + shift);
        let rise = 1.0 - open(0) * open(1);
        let gap = smooth_step(6.0, 40.0, from_bed);
        (10.5 + 5.0 * self.swell.at([at[0], at[1] + 500.0])) * rise * (0.12 + 0.88 * gap)
    }

    fn covering(&self) -> GreyMap {
        let pixel_m = EXTENT_M[0] / f64::from(COVER_PX);
        let mut levels: Vec<u8> = pixels(COVER_PX, pixel_m, 0.5).map(|at| if self.is_bare(at) { 0 } else { 255 }).collect();
        let mut put = |id: u8, places: Vec<Point>| {
            for [x, z] in places {
                levels[(z / pixel_m) as usize * COVER_PX as usize + (x / pixel_m) as usize] = id;
            }
        };
        let mut random = SplitMix64::new(2013);
        put(253, scatter(&mut random, EXTENT_M, TREES, 3.4, |at| self.tree_chance(at)));
        put(254, scatter(&mut random, EXTENT_M, STONES, 1.6, |at| self.stone_chance(at)));
        GreyMap { name: "meadow-covering.png", size_px: [COVER_PX; 2], levels: Levels::Eight(levels) }
    }

    /// The covering map with the IDs from `brush` painted on its grass.
    fn painted(&self, name: &'static str, brush: impl Fn(Point) -> Option<u8>) -> GreyMap {
        let GreyMap { size_px, levels: Levels::Eight(mut levels), .. } = self.covering() else {
            unreachable!("the covering map has 8 bits")
        };
        let pixel_m = EXTENT_M[0] / f64::from(COVER_PX);
        for (level, at) in levels.iter_mut().zip(pixels(COVER_PX, pixel_m, 0.5)).filter(|(level, _)| **level == 255) {
            *level = brush(at).unwrap_or(*level);
        }
        GreyMap { name, size_px, levels: Levels::Eight(levels) }
    }

    /// The wettest part of the valley floor.
    fn is_wet(&self, at: Point, [from_m, to_m]: [f64; 2]) -> bool {
        let along = smooth_step(from_m, from_m + 14.0, at[1]) * (1.0 - smooth_step(to_m - 16.0, to_m, at[1]));
        self.bed.distance(at) < along * (2.4 + 3.6 * self.wear.at(at))
    }

    fn is_drift(&self, at: Point) -> bool {
        let from_bed = self.bed.distance(at);
        from_bed > 9.0 && from_bed < 34.0 && self.groves.at([at[0] + 700.0, at[1]]) + 0.6 * self.wear.at(at) > 0.52
    }

    /// The trail's two ruts, with grass between them, and worn patches beside it.
    fn is_bare(&self, at: Point) -> bool {
        let wear = self.wear.at(at);
        let from_trail = self.trail.distance(at);
        let rut = (from_trail - 0.85).abs() < 0.42 + 0.18 * wear;
        let patch = wear > 0.25 + 0.004 * from_trail.min(20.0) && from_trail > 1.5;
        rut || patch
    }

    /// Groves on the hills; the centre of the valley and the trail stay open.
    fn tree_chance(&self, at: Point) -> f64 {
        let open = smooth_step(38.0, 66.0, distance(at, [128.0, 140.0])) * smooth_step(4.0, 8.0, self.trail.distance(at));
        let margin = (0..2).all(|axis| (2.0..EXTENT_M[axis] - 2.0).contains(&at[axis]));
        let grove = smooth_step(0.12, 0.42, self.groves.at(at));
        let lone = 0.006;
        if margin { open * (grove + lone) } else { 0.0 }
    }

    /// Outcrops on the knolls, a few stones elsewhere, none in the ruts.
    fn stone_chance(&self, at: Point) -> f64 {
        let knoll = KNOLLS.iter().map(|&(centre, radius, _)| bump(at, centre, 0.7 * radius)).fold(0.0, f64::max);
        let clear = smooth_step(2.0, 3.0, self.trail.distance(at)) * smooth_step(8.0, 30.0, distance(at, [128.0, 150.0]));
        clear * (0.006 + knoll * smooth_step(0.1, 0.4, self.wear.at(at)))
    }
}
