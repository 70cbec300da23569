//! Maps of `blades`: a gently rolling lawn with a bare ring, a few stones and two trees.

use super::grey_map::{GreyMap, Levels};
use super::landforms::{Noise, Point, distance, smooth_step};

/// Height map: pixels per side, spacing (m), metres per grey level.
const HEIGHT_PX: u32 = 65;
const PIXEL_M: f64 = 1.0;
const LEVEL_M: f64 = 0.02;

/// Covering map: pixels per side over the same 64 m.
const COVER_PX: u32 = 128;

const TREES: [[u32; 2]; 2] = [[24, 30], [104, 40]];
const STONES: [[u32; 2]; 5] = [[80, 52], [84, 55], [40, 84], [58, 24], [100, 96]];

/// Height map and covering map.
pub(super) fn maps() -> [GreyMap; 2] {
    let (swell, wear) = (Noise::new(31, 30.0, 2, 0.5), Noise::new(32, 4.0, 2, 0.5));
    let points = |side: u32, spacing_m: f64| {
        (0..side).flat_map(move |row| (0..side).map(move |column| -> Point { [column, row].map(|i| f64::from(i) * spacing_m) }))
    };
    let levels = points(HEIGHT_PX, PIXEL_M).map(|at| ((1.2 + 0.8 * swell.at(at)) / LEVEL_M).round().clamp(0.0, 255.0) as u8);
    let height = GreyMap { name: "blades-height.png", size_px: [HEIGHT_PX; 2], levels: Levels::Eight(levels.collect()) };
    let is_bare = |at: Point| {
        let from_ring = (distance(at, [38.0, 36.0]) - 5.0).abs();
        from_ring + 0.5 * wear.at(at) < 0.55 * smooth_step(0.0, 8.0, at[0])
    };
    let mut levels: Vec<u8> = points(COVER_PX, 0.5).map(|at| if is_bare(at) { 0 } else { 255 }).collect();
    for (id, places) in [(253, TREES.as_slice()), (254, STONES.as_slice())] {
        places.iter().for_each(|[x, z]| levels[(z * COVER_PX + x) as usize] = id);
    }
    [height, GreyMap { name: "blades-covering.png", size_px: [COVER_PX; 2], levels: Levels::Eight(levels) }]
}
