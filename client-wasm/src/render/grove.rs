//! Trees and stones with a bound each, however they sway, by squares of the land, so that a frame looks at those alone that it may show.

use super::flora::Standing;
use super::mesh::Solid;
use glam::Vec3;
use std::ops::Range;

/// Side of a square (m).
const SQUARE_M: f32 = 32.0;
/// Distance up to which stones are drawn, over that of trees.
const STONE_REACH: f32 = 0.4;
/// Most that leaves flutter (m): 0.035 · 1.9 along (1, 0.6, −1), as `placed` in `objects.wgsl` has it.
const FLUTTER_M: f32 = 0.103;

/// A ball about a model, or about what stands somewhere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    pub(super) middle_m: Vec3,
    pub(super) radius_m: f32,
}

impl Ball {
    /// About all shapes that a model has, its middle above its foot.
    pub(super) fn about<'a>(solids: impl Iterator<Item = &'a Solid>) -> Self {
        let places: Vec<Vec3> = solids.flat_map(|solid| &solid.vertices).map(|vertex| Vec3::from(vertex.position)).collect();
        let [low, high] = places.iter().fold([f32::MAX, f32::MIN], |[low, high], at| [low.min(at.y), high.max(at.y)]);
        let middle_m = Vec3::Y * (0.5 * (low + high));
        Self { middle_m, radius_m: places.iter().map(|at| at.distance(middle_m)).fold(0.0, f32::max) }
    }

    /// About what stands somewhere, whose model this is about, as far as the wind moves it.
    pub(super) fn of(self, standing: &Standing) -> Self {
        let placed = &standing.world_from_model;
        let [wide_m, tall_m, deep_m] = [placed.x_axis, placed.y_axis, placed.z_axis].map(|axis| axis.length());
        let [.., sway_rad] = standing.tint;
        // As `swayed` in `objects.wgsl` has it, for the top.
        let top = self.middle_m.y + self.radius_m;
        let swayed_m = tall_m * (sway_rad * top * top + 2.0 / 3.0 * sway_rad * sway_rad * top * top * top);
        let flutter_m = if standing.is_tree { FLUTTER_M } else { 0.0 };
        let radius_m = self.radius_m * wide_m.max(tall_m).max(deep_m) + swayed_m + flutter_m;
        Self { middle_m: placed.transform_point3(self.middle_m), radius_m }
    }

    /// About others.
    fn around(balls: impl Iterator<Item = Self> + Clone) -> Self {
        let ends = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        let [low_m, high_m] = balls.clone().map(|ball| ball.corners_m()).fold(ends, |[low, high], own| [low.min(own[0]), high.max(own[1])]);
        let middle_m = 0.5 * (low_m + high_m);
        Self { middle_m, radius_m: balls.map(|ball| ball.middle_m.distance(middle_m) + ball.radius_m).fold(0.0, f32::max) }
    }

    /// Corners of the box about it.
    pub(super) fn corners_m(&self) -> [Vec3; 2] {
        [self.middle_m - self.radius_m, self.middle_m + self.radius_m]
    }
}

/// What stands on a square of the land.
struct Square {
    row: i32,
    ball: Ball,
    own: Range<usize>,
}

pub(super) struct Grove {
    /// Square by square.
    all: Vec<(Standing, Ball)>,
    /// Row by row.
    squares: Vec<Square>,
}

impl Grove {
    pub(super) fn new(mut all: Vec<(Standing, Ball)>) -> Self {
        let place = |own: &(Standing, Ball)| [own.0.position_m.z, own.0.position_m.x].map(number);
        all.sort_by_key(place);
        let mut squares = Vec::new();
        let mut first = 0;
        for own in all.chunk_by(|a, b| place(a) == place(b)) {
            let ball = Ball::around(own.iter().map(|(_, ball)| *ball));
            squares.push(Square { row: place(&own[0])[0], ball, own: first..first + own.len() });
            first += own.len();
        }
        Self { all, squares }
    }

    /// With their distances what is drawn up to `reach_m` from the eye, of more than `most` the nearest: all but what stands on squares that may not show; nearest
    /// squares first.
    pub(super) fn near(&self, eye_m: Vec3, reach_m: f32, most: usize, may_show: impl Fn(&Ball) -> bool) -> Vec<(f32, &(Standing, Ball))> {
        let first = self.squares.partition_point(|square| square.row < number(eye_m.z - reach_m));
        let end = self.squares.partition_point(|square| square.row <= number(eye_m.z + reach_m));
        let nearest_m = |square: &Square| square.ball.middle_m.distance(eye_m) - square.ball.radius_m;
        let with_distance = self.squares[first..end].iter().map(|square| (nearest_m(square), square));
        let mut squares: Vec<(f32, &Square)> = with_distance.filter(|(nearest_m, _)| *nearest_m < reach_m).collect();
        let drawn = |square: &Square| {
            let own = self.all[square.own.clone()].iter().map(|own| (own.0.position_m.distance(eye_m), own));
            own.filter(|(distance_m, (standing, _))| *distance_m < reach_m * if standing.is_tree { 1.0 } else { STONE_REACH })
        };
        let mut limit_m = f32::INFINITY;
        if squares.iter().map(|(_, square)| square.own.len()).sum::<usize>() > most {
            let mut distances_m: Vec<f32> =
                squares.iter().flat_map(|(_, square)| drawn(square)).map(|(distance_m, _)| distance_m).collect();
            if distances_m.len() > most {
                limit_m = *distances_m.select_nth_unstable_by(most, f32::total_cmp).1;
            }
        }
        squares.retain(|(_, square)| may_show(&square.ball));
        squares.sort_by(|a, b| a.0.total_cmp(&b.0));
        squares.into_iter().flat_map(|(_, square)| drawn(square)).filter(|(distance_m, _)| *distance_m < limit_m).collect()
    }
}

/// Number of the square along an axis.
fn number(m: f32) -> i32 {
    (m / SQUARE_M).floor() as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Mat4;
    use shared::hash::hash3;

    fn standing(n: u32) -> (Standing, Ball) {
        let [x, z, lot] = hash3([n, 2, 6]).map(|v| (v >> 8) as f32 / 16_777_216.0);
        let position_m = Vec3::new(400.0 * x - 40.0, 3.0 * lot, 300.0 * z - 40.0);
        let world_from_model = Mat4::from_translation(position_m);
        let standing = Standing { position_m, shape: 0, is_tree: lot < 0.7, size_m: 5.0, world_from_model, tint: [0.0; 4] };
        (standing, Ball { middle_m: position_m + 3.0 * Vec3::Y, radius_m: 4.0 })
    }

    fn sorted(distances_m: impl Iterator<Item = f32>) -> Vec<f32> {
        let mut distances_m: Vec<f32> = distances_m.collect();
        distances_m.sort_by(f32::total_cmp);
        distances_m
    }

    #[test]
    fn what_is_near_and_may_show_is_found_and_of_too_many_the_nearest() {
        let all: Vec<_> = (0..900).map(standing).collect();
        let grove = Grove::new(all.clone());
        assert!(grove.squares.len() > 80);
        let may_show = |ball: &Ball| ball.middle_m.x - ball.radius_m < 120.0;
        for (eye_m, reach_m) in [(Vec3::new(100.0, 2.0, 90.0), 110.0), (Vec3::new(-60.0, 40.0, 250.0), 200.0), (Vec3::ZERO, 1000.0)] {
            let distance_m = |own: &(Standing, Ball)| own.0.position_m.distance(eye_m);
            let is_near = |own: &&(Standing, Ball)| distance_m(own) < reach_m * if own.0.is_tree { 1.0 } else { 0.4 };
            let wanted = sorted(all.iter().filter(is_near).filter(|own| may_show(&own.1)).map(distance_m));
            let near = grove.near(eye_m, reach_m, all.len(), may_show);
            let found = sorted(near.iter().filter(|(_, own)| may_show(&own.1)).map(|(distance_m, _)| *distance_m));
            assert!(wanted.len() > 60 && found == wanted, "{} of {}", found.len(), wanted.len());
            let nearest = sorted(all.iter().filter(is_near).map(distance_m));
            let few = grove.near(eye_m, reach_m, 50, |_| true);
            assert_eq!(sorted(few.iter().map(|(distance_m, _)| *distance_m)), nearest[..50]);
        }
    }
}
