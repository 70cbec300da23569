//! Where a new object is put.

use super::ground::Ground;
use super::place::Place;

/// Candidates that are tried, along a spiral.
const TRIES: u32 = 4096;
/// Distance of the first candidate from the middle (m).
const FIRST_M: f32 = 9.0;
/// Distance from one candidate to the next where nothing asks for more, about (m).
pub(super) const NEAR_M: f32 = 4.0;
/// Angle from one candidate to the next: the golden angle (rad).
const GOLDEN_RAD: f32 = 2.399_963;
/// Steepest land that an object is put on, as rise over run.
const STEEP: f32 = 0.6;

/// A circle on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Disc {
    pub(super) at_m: [f32; 2],
    pub(super) radius_m: f32,
}

/// The first place along a spiral around `middle_m`, whose turns and candidates lie about `apart_m` from each other, where a disc of `radius_m` meets no other object, tree, stone or edge; on
/// gentle land if there is any.
pub(super) fn find(middle_m: [f32; 2], apart_m: f32, radius_m: f32, taken: &[Disc], ground: &Ground, place: &Place) -> Option<[f32; 2]> {
    let bounds = place.bounds_m();
    let middle: [f32; 2] = std::array::from_fn(|axis| middle_m[axis].clamp(bounds[axis][0], bounds[axis][1]));
    let is_clear = |&at: &[f32; 2]| {
        let inside = (0..2).all(|axis| (bounds[axis][0]..=bounds[axis][1]).contains(&at[axis]));
        let apart = taken.iter().all(|disc| {
            let [x, z] = [at[0] - disc.at_m[0], at[1] - disc.at_m[1]];
            let reach = radius_m + disc.radius_m;
            x * x + z * z > reach * reach
        });
        inside && apart && ground.is_free(at, radius_m)
    };
    let is_gentle = |at: &[f32; 2]| {
        let [x, z] = ground.slope(*at);
        x * x + z * z < STEEP * STEEP
    };
    let mut clear = (0..TRIES).map(|n| spiral(middle, apart_m, n)).filter(is_clear).peekable();
    let steep = clear.peek().copied();
    clear.find(is_gentle).or(steep)
}

fn spiral(middle: [f32; 2], apart_m: f32, n: u32) -> [f32; 2] {
    let radius = (FIRST_M * FIRST_M + apart_m * apart_m * n as f32).sqrt();
    let (sin, cos) = (n as f32 * GOLDEN_RAD).sin_cos();
    [middle[0] + radius * cos, middle[1] + radius * sin]
}
