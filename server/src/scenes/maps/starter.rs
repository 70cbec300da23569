//! Maps of the scene that `prairie new` writes: a hill with a lane over it, a dry pond with sedge, trees and stones.

use super::grey_map::{GreyMap, Levels};
use super::landforms::{Noise, Point, Spline, bump, distance, scatter, smooth_step};
use prairie_core::random::SplitMix64;

const EXTENT_M: Point = [128.0, 128.0];

/// Height map: pixels per side, spacing (m), metres per grey level.
const HEIGHT_PX: u32 = 129;
const PIXEL_M: f64 = 1.0;
const LEVEL_M: f64 = 0.06;

/// Covering map: pixels per side over the same 128 m, and ID of the sedge.
const COVER_PX: u32 = 256;
const SEDGE: u8 = 10;

/// Rises: centre (m), radius (m), height (m). The hill, a knoll in the west, and a ramp on the lane that cars jump.
const HILL: (Point, f64, f64) = ([74.0, 50.0], 26.0, 8.5);
const RISES: [(Point, f64, f64); 3] = [HILL, ([26.0, 36.0], 13.0, 3.0), ([91.0, 84.0], 4.5, 1.1)];

/// Centre (m) and radius (m) of the pond.
const POND: (Point, f64) = ([36.0, 86.0], 12.0);

/// The lane, from the southern edge over the ramp and round the hill to its top.
const LANE: [Point; 8] =
    [[62.0, 134.0], [64.0, 108.0], [82.0, 90.0], [98.0, 78.0], [104.0, 52.0], [86.0, 30.0], [64.0, 34.0], [73.0, 51.0]];

const TREES: usize = 55;
const STONES: usize = 60;

/// Height map and covering map.
pub(super) fn maps() -> [GreyMap; 2] {
    let land = Starter { lane: Spline::through(&LANE), swell: Noise::smooth(51, 44.0, 2, 0.45), wear: Noise::new(52, 6.0, 3, 0.6) };
    let points = |side: u32, spacing_m: f64, offset: f64| {
        (0..side).flat_map(move |row| (0..side).map(move |column| -> Point { [column, row].map(|i| (f64::from(i) + offset) * spacing_m) }))
    };
    let levels = points(HEIGHT_PX, PIXEL_M, 0.0).map(|at| (land.height_m(at) / LEVEL_M).round().clamp(0.0, 255.0) as u8);
    let height = GreyMap { name: "height.png", size_px: [HEIGHT_PX; 2], levels: Levels::Eight(levels.collect()) };

    let pixel_m = EXTENT_M[0] / f64::from(COVER_PX);
    let mut levels: Vec<u8> = points(COVER_PX, pixel_m, 0.5).map(|at| land.cover(at)).collect();
    let mut random = SplitMix64::new(2026);
    let trees = scatter(&mut random, EXTENT_M, TREES, 4.0, |at| land.tree_chance(at));
    let stones = scatter(&mut random, EXTENT_M, STONES, 2.0, |at| land.stone_chance(at));
    for (id, places) in [(253, trees), (254, stones)] {
        for [x, z] in places {
            levels[(z / pixel_m) as usize * COVER_PX as usize + (x / pixel_m) as usize] = id;
        }
    }
    [height, GreyMap { name: "covering.png", size_px: [COVER_PX; 2], levels: Levels::Eight(levels) }]
}

struct Starter {
    lane: Spline,
    swell: Noise,
    wear: Noise,
}

impl Starter {
    fn height_m(&self, at: Point) -> f64 {
        let rises: f64 = RISES.iter().map(|&(centre, radius, height)| height * bump(at, centre, radius)).sum();
        3.4 + rises - 2.4 * bump(at, POND.0, POND.1) + self.swell.at(at)
    }

    /// Bare ground in the pond and in the two ruts of the lane, sedge round the pond, grass elsewhere.
    fn cover(&self, at: Point) -> u8 {
        let wear = self.wear.at(at);
        let from_pond = distance(at, POND.0) + 2.0 * wear;
        let is_rut = (self.lane.distance(at) - 0.85).abs() < 0.42 + 0.18 * wear;
        match from_pond / POND.1 {
            _ if is_rut => 0,
            near if near < 0.55 => 0,
            near if near < 0.95 => SEDGE,
            _ => 255,
        }
    }

    /// A grove in the west and single trees; none near the lane, the pond and the top of the hill.
    fn tree_chance(&self, at: Point) -> f64 {
        let grove = 0.5 * bump(at, [20.0, 50.0], 16.0) + 0.3 * bump(at, [112.0, 112.0], 14.0) + 0.02;
        let open = smooth_step(7.0, 11.0, self.lane.distance(at)) * smooth_step(13.0, 17.0, distance(at, POND.0));
        let margin = (0..2).all(|axis| (2.0..EXTENT_M[axis] - 2.0).contains(&at[axis]));
        if margin { open * grove * smooth_step(18.0, 30.0, distance(at, HILL.0)) } else { 0.0 }
    }

    /// Outcrops on the slopes of the hill, a few stones elsewhere, none on the lane.
    fn stone_chance(&self, at: Point) -> f64 {
        let slope = smooth_step(12.0, 18.0, distance(at, HILL.0)) * bump(at, HILL.0, 26.0);
        smooth_step(5.0, 7.0, self.lane.distance(at)) * (0.01 + slope * smooth_step(0.0, 0.4, self.wear.at(at)))
    }
}
