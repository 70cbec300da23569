//! Spatial index of trees, stones and models of the scene's own: squares of the land with a bounding sphere each, so that a frame visits only those that may be visible.

use crate::render::solids::bounding_sphere::BoundingSphere;
use crate::render::solids::trees_and_stones::{PlacedKind, PlacedModel};
use glam::Vec3;
use std::ops::Range;

/// Side of a square (m).
const SQUARE_M: f32 = 32.0;
/// Maximum distance of stones, relative to that of trees and models of the scene's own.
const STONE_REACH: f32 = 0.4;

/// The models on a square of the land.
struct Square {
    row: i32,
    bounds: BoundingSphere,
    models: Range<usize>,
}

/// A placed model near the eye.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NearModel<'a> {
    pub(crate) distance_m: f32,
    /// Its number among all models of the scene.
    pub(crate) number: u32,
    pub(crate) placed: &'a PlacedModel,
    pub(crate) bounds: &'a BoundingSphere,
}

/// Placed models by square.
pub(crate) struct SpatialIndex {
    /// Sorted by square.
    models: Vec<(PlacedModel, BoundingSphere)>,
    /// Sorted by row.
    squares: Vec<Square>,
}

impl SpatialIndex {
    pub(crate) fn new(mut models: Vec<(PlacedModel, BoundingSphere)>) -> Self {
        let square = |own: &(PlacedModel, BoundingSphere)| [own.0.position_m.z, own.0.position_m.x].map(square_number);
        models.sort_by_key(square);
        let mut squares = Vec::new();
        let mut first = 0;
        for own in models.chunk_by(|a, b| square(a) == square(b)) {
            let bounds = BoundingSphere::around_spheres(own.iter().map(|(_, bounds)| *bounds));
            squares.push(Square { row: square(&own[0])[0], bounds, models: first..first + own.len() });
            first += own.len();
        }
        Self { models, squares }
    }

    /// Number of all models.
    pub(crate) fn count(&self) -> u32 {
        self.models.len() as u32
    }

    /// Models up to `reach_m` from the eye, nearest squares first: at most the nearest `limit`, without those on squares for which
    /// `may_show` is false.
    pub(crate) fn near(&self, eye_m: Vec3, reach_m: f32, limit: usize, may_show: impl Fn(&BoundingSphere) -> bool) -> Vec<NearModel<'_>> {
        let first = self.squares.partition_point(|square| square.row < square_number(eye_m.z - reach_m));
        let end = self.squares.partition_point(|square| square.row <= square_number(eye_m.z + reach_m));
        let nearest_m = |square: &Square| square.bounds.centre_m.distance(eye_m) - square.bounds.radius_m;
        let with_distance = self.squares[first..end].iter().map(|square| (nearest_m(square), square));
        let mut squares: Vec<(f32, &Square)> = with_distance.filter(|(nearest_m, _)| *nearest_m < reach_m).collect();
        let within_reach = |square: &Square| {
            let own = square.models.clone().zip(&self.models[square.models.clone()]).map(|(number, (placed, bounds))| NearModel {
                distance_m: placed.position_m.distance(eye_m),
                number: number as u32,
                placed,
                bounds,
            });
            own.filter(|own| own.distance_m < reach_m * if own.placed.kind == PlacedKind::Stone { STONE_REACH } else { 1.0 })
        };
        let mut limit_m = f32::INFINITY;
        if squares.iter().map(|(_, square)| square.models.len()).sum::<usize>() > limit {
            let mut distances_m: Vec<f32> = squares.iter().flat_map(|(_, square)| within_reach(square)).map(|own| own.distance_m).collect();
            if distances_m.len() > limit {
                limit_m = *distances_m.select_nth_unstable_by(limit, f32::total_cmp).1;
            }
        }
        squares.retain(|(_, square)| may_show(&square.bounds));
        squares.sort_by(|a, b| a.0.total_cmp(&b.0));
        squares.into_iter().flat_map(|(_, square)| within_reach(square)).filter(|own| own.distance_m < limit_m).collect()
    }
}

/// Number of a square along an axis.
fn square_number(m: f32) -> i32 {
    (m / SQUARE_M).floor() as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Mat4;
    use prairie_core::hash::{hash3, unit};

    fn placed(n: u32) -> (PlacedModel, BoundingSphere) {
        let [x, z, random] = hash3([n, 2, 6]).map(unit);
        let position_m = Vec3::new(400.0 * x - 40.0, 3.0 * random, 300.0 * z - 40.0);
        let world_from_model = Mat4::from_translation(position_m);
        let kind = if random < 0.7 { PlacedKind::Tree } else { PlacedKind::Stone };
        let placed = PlacedModel { position_m, shape: 0, kind, size_m: 5.0, world_from_model, tint: [0.0; 4] };
        (placed, BoundingSphere { centre_m: position_m + 3.0 * Vec3::Y, radius_m: 4.0 })
    }

    fn sorted(distances_m: impl Iterator<Item = f32>) -> Vec<f32> {
        let mut distances_m: Vec<f32> = distances_m.collect();
        distances_m.sort_by(f32::total_cmp);
        distances_m
    }

    #[test]
    fn near_visible_models_are_found_and_the_nearest_are_kept_above_the_limit() {
        let all: Vec<_> = (0..900).map(placed).collect();
        let index = SpatialIndex::new(all.clone());
        assert!(index.squares.len() > 80);
        let may_show = |bounds: &BoundingSphere| bounds.centre_m.x - bounds.radius_m < 120.0;
        for (eye_m, reach_m) in [(Vec3::new(100.0, 2.0, 90.0), 110.0), (Vec3::new(-60.0, 40.0, 250.0), 200.0), (Vec3::ZERO, 1000.0)] {
            let distance_m = |own: &(PlacedModel, BoundingSphere)| own.0.position_m.distance(eye_m);
            let is_near = |own: &&(PlacedModel, BoundingSphere)| distance_m(own) < reach_m * if own.0.is_tree() { 1.0 } else { 0.4 };
            let wanted = sorted(all.iter().filter(is_near).filter(|own| may_show(&own.1)).map(distance_m));
            let near = index.near(eye_m, reach_m, all.len(), may_show);
            let found = sorted(near.iter().filter(|own| may_show(own.bounds)).map(|own| own.distance_m));
            assert!(wanted.len() > 60 && found == wanted, "{} of {}", found.len(), wanted.len());
            let nearest = sorted(all.iter().filter(is_near).map(distance_m));
            let few = index.near(eye_m, reach_m, 50, |_| true);
            assert_eq!(sorted(few.iter().map(|own| own.distance_m)), nearest[..50]);
        }
    }
}
