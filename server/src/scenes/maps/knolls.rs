//! Maps of `shells`: round hills of short grass, with some bare patches on the slopes.

use super::grey_map::{GreyMap, Levels};
use super::landforms::{Noise, Point, bump, smooth_step};

/// Height map: pixels per side, spacing (m), metres per grey level.
const HEIGHT_PX: u32 = 129;
const PIXEL_M: f64 = 1.0;
const LEVEL_M: f64 = 0.001;

/// Covering map: pixels per side over the same 128 m.
const COVER_PX: u32 = 512;

/// Knolls: centre (m), radius (m), height (m).
const KNOLLS: [(Point, f64, f64); 9] = [
    ([60.0, 52.0], 7.0, 2.6),
    ([75.0, 58.0], 5.5, 1.9),
    ([46.0, 62.0], 6.0, 1.7),
    ([68.0, 40.0], 9.0, 3.4),
    ([88.0, 44.0], 8.0, 2.8),
    ([40.0, 40.0], 10.0, 3.2),
    ([84.0, 76.0], 8.0, 2.2),
    ([58.0, 24.0], 13.0, 4.6),
    ([96.0, 22.0], 14.0, 5.2),
];

/// Bare patches: centre (m) and radius (m).
const WORN: [(Point, f64); 4] = [([71.5, 64.0], 0.7), ([53.0, 57.5], 0.6), ([79.0, 50.0], 1.1), ([47.0, 72.0], 0.8)];

/// Height map and covering map.
pub(super) fn maps() -> [GreyMap; 2] {
    let (swell, rough) = (Noise::smooth(41, 40.0, 2, 0.5), Noise::smooth(42, 9.0, 2, 0.4));
    let points = |side: u32, spacing_m: f64, offset: f64| {
        (0..side).flat_map(move |row| (0..side).map(move |column| -> Point { [column, row].map(|i| (f64::from(i) + offset) * spacing_m) }))
    };
    let height_m = |at: Point| {
        let knolls: f64 = KNOLLS.iter().map(|&(centre, radius, height)| height * bump(at, centre, radius)).sum();
        2.0 + knolls + 0.9 * swell.at(at) + 0.16 * rough.at(at)
    };
    let levels = points(HEIGHT_PX, PIXEL_M, 0.0).map(|at| (height_m(at) / LEVEL_M).round().clamp(0.0, 65_535.0) as u16);
    let height = GreyMap { name: "shells-height.png", size_px: [HEIGHT_PX; 2], levels: Levels::Sixteen(levels.collect()) };
    let wear = Noise::smooth(43, 1.7, 3, 0.6);
    let is_bare = |at: Point| {
        let worn: f64 = WORN.iter().map(|&(centre, radius)| bump(at, centre, radius)).sum();
        worn + 0.35 * wear.at(at) * smooth_step(0.05, 0.5, worn) > 0.5
    };
    let levels = points(COVER_PX, 0.25, 0.5).map(|at| if is_bare(at) { 0 } else { 255 });
    [height, GreyMap { name: "shells-covering.png", size_px: [COVER_PX; 2], levels: Levels::Eight(levels.collect()) }]
}
