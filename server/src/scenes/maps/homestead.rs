//! Covering map of `homestead`: a house in a yard behind fences, a path to its door, rocks in the grass and a few trees.

use super::grey_map::{GreyMap, Levels};
use super::landforms::{Noise, Point, Spline, distance, scatter};
use prairie_core::random::SplitMix64;

/// Covering map: pixels per side over 64 m.
const COVER_PX: usize = 128;
const PIXEL_M: f64 = 0.5;

/// IDs of the models in `homestead.toml`: the house, fences from west to east and from north to south, and the rocks.
const HOUSE: u8 = 1;
const FENCE: u8 = 2;
const CROSS_FENCE: u8 = 3;
const ROCK: u8 = 4;

const HOUSE_M: Point = [26.0, 22.0];
const TREES_M: [Point; 4] = [[38.0, 13.0], [13.0, 17.0], [52.0, 24.0], [57.0, 9.0]];
/// Distance between the pieces of a fence (m).
const PIECE_M: f64 = 3.0;
const ROCKS: usize = 7;

/// The covering map; the heights are those of `blades`.
pub(super) fn covering() -> GreyMap {
    let wear = Noise::new(61, 5.0, 2, 0.5);
    let path = Spline::through(&[[33.0, 62.0], [30.0, 48.0], [27.5, 37.0], [25.5, 26.0]]);
    let middle = |i: usize| [i % COVER_PX, i / COVER_PX].map(|pixel| (pixel as f64 + 0.5) * PIXEL_M);
    let is_bare = |at: Point| path.distance(at) + 0.5 * wear.at(at) < 0.9;
    let mut levels: Vec<u8> = (0..COVER_PX * COVER_PX).map(|i| if is_bare(middle(i)) { 0 } else { 255 }).collect();
    let mut put = |at: Point, id: u8| levels[(at[1] / PIXEL_M) as usize * COVER_PX + (at[0] / PIXEL_M) as usize] = id;
    put(HOUSE_M, HOUSE);
    TREES_M.into_iter().for_each(|at| put(at, 253));
    // A gate of two pieces is left open where the path comes in.
    for piece in (0..12).filter(|piece| ![6, 7].contains(piece)) {
        put([8.0 + PIECE_M * f64::from(piece), 37.0], FENCE);
    }
    for piece in 0..8 {
        put([42.5, 14.5 + PIECE_M * f64::from(piece)], CROSS_FENCE);
    }
    let mut random = SplitMix64::new(1862);
    let is_open = |at: Point| {
        at[1] > 42.0 && path.distance(at) > 3.0 && distance(at, [35.0, 57.0]) > 6.0 && at.iter().all(|m| (3.0..61.0).contains(m))
    };
    for at in scatter(&mut random, [64.0; 2], ROCKS, 5.0, |at| f64::from(u8::from(is_open(at)))) {
        put(at, ROCK);
    }
    GreyMap { name: "homestead-covering.png", size_px: [COVER_PX as u32; 2], levels: Levels::Eight(levels) }
}
