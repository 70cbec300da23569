//! The land as the bodies meet it: tiles of terrain, trunks and stones, kept only near the objects.

use super::place::Place;
use rapier3d::parry::utils::Array2;
use rapier3d::prelude::*;
use shared::scene::Plants;
use shared::terrain::{Cover, HeightMap};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Members of the collision group of the land; whoever follows the land by itself leaves it out.
pub(super) const LAND: Group = Group::GROUP_2;

/// Least side of a tile (m).
const TILE_M: f32 = 24.0;
/// Coarsest and finest distance between the heights of a tile (m).
const SPACING_M: [f32; 2] = [0.1, 2.0];
/// A tile is made when an object is this near (m), and dropped when none is within [`KEEP_M`].
const MAKE_M: f32 = 12.0;
const KEEP_M: f32 = 30.0;
/// Most trees and stones that stand in the way within a tile; a denser covering is passable.
const THINGS_PER_TILE: usize = 256;
/// Radius of a trunk as a share of the tree's height.
const TRUNK_SHARE: f32 = 0.03;

type Tile = [i32; 2];

/// A tree or a stone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Thing {
    pub(super) at_m: [f32; 2],
    pub(super) radius_m: f32,
    pub(super) half_height_m: Option<f32>,
}

/// Terrain, trunks and stones.
pub(super) struct Ground {
    height: Arc<HeightMap>,
    spacing_m: [f32; 2],
    tile_m: [f32; 2],
    things: BTreeMap<Tile, Vec<Thing>>,
    made: BTreeMap<Tile, Vec<ColliderHandle>>,
}

impl Ground {
    pub(super) fn new(place: &Place, plants: &Plants) -> Self {
        let height = place.height.clone();
        let spacing_m = height.pixel_m().map(spacing_m);
        let tile_m = spacing_m.map(|spacing| (TILE_M / spacing).ceil() * spacing);
        let mut ground = Self { height, spacing_m, tile_m, things: BTreeMap::new(), made: BTreeMap::new() };
        let tree = |at_m| Thing { at_m, radius_m: plants.tree_m * TRUNK_SHARE, half_height_m: Some(0.5 * plants.tree_m) };
        let stone = |at_m| Thing { at_m, radius_m: 0.5 * plants.stone_m, half_height_m: None };
        place.cover.places_m(Cover::Tree, place.extent_m).for_each(|at_m| ground.put(tree(at_m)));
        place.cover.places_m(Cover::Stone, place.extent_m).for_each(|at_m| ground.put(stone(at_m)));
        ground
    }

    /// Height of the land (m).
    pub(super) fn height_m(&self, at_m: [f32; 2]) -> f32 {
        self.height.height_m(at_m[0], at_m[1])
    }

    /// Slope of the land (∂h/∂x, ∂h/∂z).
    pub(super) fn slope(&self, at_m: [f32; 2]) -> [f32; 2] {
        self.height.slope(at_m[0], at_m[1])
    }

    /// Whether no tree or stone stands within `radius_m`.
    pub(super) fn is_free(&self, at_m: [f32; 2], radius_m: f32) -> bool {
        self.tiles_around(at_m, radius_m + TILE_M).all(|tile| {
            self.things.get(&tile).is_none_or(|things| {
                things.iter().all(|thing| {
                    let reach = radius_m + thing.radius_m;
                    squared_distance(thing.at_m, at_m) > reach * reach
                })
            })
        })
    }

    /// Whether no tile is made.
    pub(super) fn is_empty(&self) -> bool {
        self.made.is_empty()
    }

    /// Makes the tiles near `objects_m`, drops those that are far from all.
    pub(super) fn follow(&mut self, objects_m: &[[f32; 2]], physics: &mut PhysicsWorld) {
        let around = |reach_m| objects_m.iter().flat_map(|&at_m| self.tiles_around(at_m, reach_m)).collect::<BTreeSet<_>>();
        let (make, keep) = (around(MAKE_M), around(KEEP_M));
        self.made.retain(|tile, colliders| {
            let stays = keep.contains(tile);
            if !stays {
                for &collider in colliders.iter() {
                    physics.remove_collider(collider);
                }
            }
            stays
        });
        for tile in make {
            if !self.made.contains_key(&tile) {
                let colliders = self.colliders(tile).into_iter().map(|collider| physics.insert_collider(collider, None)).collect();
                self.made.insert(tile, colliders);
            }
        }
    }

    fn put(&mut self, thing: Thing) {
        let things = self.things.entry(self.tile_at(thing.at_m)).or_default();
        if things.len() < THINGS_PER_TILE {
            things.push(thing);
        }
    }

    fn tile_at(&self, at_m: [f32; 2]) -> Tile {
        std::array::from_fn(|axis| (at_m[axis] / self.tile_m[axis]).floor() as i32)
    }

    fn tiles_around(&self, at_m: [f32; 2], reach_m: f32) -> impl Iterator<Item = Tile> + use<> {
        let [x0, z0] = self.tile_at(at_m.map(|m| m - reach_m));
        let [x1, z1] = self.tile_at(at_m.map(|m| m + reach_m));
        (z0..=z1).flat_map(move |z| (x0..=x1).map(move |x| [x, z]))
    }

    fn colliders(&self, tile: Tile) -> Vec<ColliderBuilder> {
        let groups = InteractionGroups::new(LAND, Group::ALL, InteractionTestMode::And);
        let mut colliders = vec![self.terrain(tile).collision_groups(groups)];
        for thing in self.things.get(&tile).into_iter().flatten() {
            let [x, z] = thing.at_m;
            let foot = self.height_m(thing.at_m);
            colliders.push(match thing.half_height_m {
                Some(half) => ColliderBuilder::cylinder(half, thing.radius_m).translation(Vector::new(x, foot + half, z)),
                None => ColliderBuilder::ball(thing.radius_m).translation(Vector::new(x, foot, z)),
            });
        }
        colliders
    }

    /// The terrain of a tile. The land is bilinear between pixels, the collider flat between its nodes; they differ by at most a
    /// quarter of the twist of one node cell.
    fn terrain(&self, tile: Tile) -> ColliderBuilder {
        let [columns, rows] = std::array::from_fn(|axis| (self.tile_m[axis] / self.spacing_m[axis]).round() as usize + 1);
        let corner: [f32; 2] = std::array::from_fn(|axis| tile[axis] as f32 * self.tile_m[axis]);
        let mut heights = Array2::zeros(rows, columns);
        for row in 0..rows {
            for column in 0..columns {
                let x = corner[0] + column as f32 * self.spacing_m[0];
                let z = corner[1] + row as f32 * self.spacing_m[1];
                heights[(row, column)] = self.height_m([x, z]);
            }
        }
        let center = Vector::new(corner[0] + 0.5 * self.tile_m[0], 0.0, corner[1] + 0.5 * self.tile_m[1]);
        let scale = Vector::new(self.tile_m[0], 1.0, self.tile_m[1]);
        // Without this a ball that rolls over flat land bounces off the edges of its triangles.
        let flags = HeightFieldFlags::FIX_INTERNAL_EDGES;
        ColliderBuilder::heightfield_with_flags(heights, scale, flags).translation(center).friction(0.8)
    }
}

/// Distance between the heights of a tile: a part or a multiple of the map's pixels, so that the land's creases stay.
fn spacing_m(pixel_m: f32) -> f32 {
    let [fine, coarse] = SPACING_M;
    if pixel_m >= coarse { pixel_m / (pixel_m / coarse).ceil() } else { pixel_m * (fine / pixel_m).ceil() }
}

fn squared_distance(a: [f32; 2], b: [f32; 2]) -> f32 {
    let [x, z] = [a[0] - b[0], a[1] - b[1]];
    x * x + z * z
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_meet_the_pixels() {
        for pixel_m in [0.01, 0.07, 0.1, 0.5, 1.9, 2.0, 7.3, 75.0] {
            let spacing = spacing_m(pixel_m);
            let ratio = if spacing > pixel_m { spacing / pixel_m } else { pixel_m / spacing };
            assert!((ratio - ratio.round()).abs() < 1e-4, "{pixel_m}: {spacing}");
            assert!((0.0999..=2.0001).contains(&spacing), "{pixel_m}: {spacing}");
        }
    }
}
