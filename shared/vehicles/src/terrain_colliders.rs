//! Colliders of terrain, tree trunks, stones, the models of the covering map and the posts of gates, which exist only near the objects.

use super::environment::Environment;
use prairie_core::race::{GatePost, POST_HALF_M};
use prairie_core::scene::Scene;
use prairie_core::terrain::{Cover, HeightMap, ModelBox, model_boxes};
use rapier3d::parry::utils::Array2;
use rapier3d::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Collision group of the terrain. Vehicles that follow the terrain themselves exclude it.
pub(crate) const TERRAIN: Group = Group::GROUP_2;

/// Minimum side of a tile (m).
const TILE_M: f32 = 24.0;
/// Finest and coarsest distance between the heights of a tile (m).
const SPACING_M: [f32; 2] = [0.1, 2.0];
/// A tile is created when an object is within this distance (m), and removed when no object is within [`KEEP_M`]; where models stand, both are farther by
/// the reach of the largest.
const CREATE_M: f32 = 12.0;
const KEEP_M: f32 = 30.0;
/// Largest number of trees and stones in a tile that are obstacles; any others can be driven through.
const OBSTACLES_PER_TILE: usize = 256;
/// Radius of a trunk relative to the tree's height.
const TRUNK_RADIUS: f32 = 0.03;

/// Index of a tile along X and Z.
pub type TileIndex = [i32; 2];

/// A tree, a stone, a model of the covering map or a post of a gate.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Obstacle {
    Trunk { at_m: [f32; 2], radius_m: f32, half_height_m: f32 },
    Stone { at_m: [f32; 2], radius_m: f32 },
    Model(ModelBox),
    Post(GatePost),
}

impl Obstacle {
    fn at_m(&self) -> [f32; 2] {
        match self {
            Self::Trunk { at_m, .. } | Self::Stone { at_m, .. } => *at_m,
            Self::Model(own) => own.at_m,
            Self::Post(post) => post.at_m,
        }
    }

    /// Whether it is farther than `reach_m` from a point, seen from above.
    fn is_beyond(&self, from_m: [f32; 2], reach_m: f32) -> bool {
        match self {
            Self::Trunk { at_m, radius_m, .. } | Self::Stone { at_m, radius_m } => {
                let reach = reach_m + radius_m;
                squared_distance(*at_m, from_m) > reach * reach
            }
            Self::Model(own) => own.squared_distance_m2(from_m) > reach_m * reach_m,
            Self::Post(post) => {
                let reach = reach_m + std::f32::consts::SQRT_2 * POST_HALF_M;
                squared_distance(post.at_m, from_m) > reach * reach
            }
        }
    }

    fn collider(&self, height: &HeightMap) -> ColliderBuilder {
        let [x, z] = self.at_m();
        let foot = height.height_m(x, z);
        match self {
            Self::Trunk { radius_m, half_height_m, .. } => {
                ColliderBuilder::cylinder(*half_height_m, *radius_m).translation(Vector::new(x, foot + half_height_m, z))
            }
            Self::Stone { radius_m, .. } => ColliderBuilder::ball(*radius_m).translation(Vector::new(x, foot, z)),
            Self::Model(own) => {
                let [half_x, half_y, half_z] = own.half_m;
                let center = Vector::new(x, own.floor_m(|x, z| height.height_m(x, z)) + half_y, z);
                ColliderBuilder::cuboid(half_x, half_y, half_z).position(Pose::from_parts(center, Rotation::from_array(own.rotation())))
            }
            Self::Post(post) => {
                let [bottom_m, top_m] = post.span_m;
                let center = Vector::new(x, 0.5 * (bottom_m + top_m), z);
                ColliderBuilder::cuboid(POST_HALF_M, 0.5 * (top_m - bottom_m), POST_HALF_M)
                    .position(Pose::from_parts(center, Rotation::from_array(post.rotation())))
            }
        }
    }
}

/// Colliders of terrain, trunks, stones, models and posts of gates.
pub struct TerrainColliders {
    height: Arc<HeightMap>,
    spacing_m: [f32; 2],
    tile_m: [f32; 2],
    /// Radius of the largest model (m); 0 without models.
    model_reach_m: f32,
    obstacles: BTreeMap<TileIndex, Vec<Obstacle>>,
    created: BTreeMap<TileIndex, Vec<ColliderHandle>>,
}

impl TerrainColliders {
    /// No colliders yet, on the terrain of `environment`, with the trees, stones and models of its cover and the gates of the scene's race.
    pub fn new(environment: &Environment, scene: &Scene) -> Self {
        let height = environment.height.clone();
        let spacing_m = height.pixel_m().map(spacing_m);
        let tile_m = spacing_m.map(|spacing| (TILE_M / spacing).ceil() * spacing);
        let models = model_boxes(scene, &environment.cover);
        let model_reach_m = models.iter().map(ModelBox::radius_m).fold(0.0, f32::max);
        let mut colliders = Self { height, spacing_m, tile_m, model_reach_m, obstacles: BTreeMap::new(), created: BTreeMap::new() };
        let plants = &scene.plants;
        let tree = |at_m| Obstacle::Trunk { at_m, radius_m: plants.tree_m * TRUNK_RADIUS, half_height_m: 0.5 * plants.tree_m };
        let stone = |at_m| Obstacle::Stone { at_m, radius_m: 0.5 * plants.stone_m };
        environment.cover.places_m(Cover::Tree, environment.extent_m).for_each(|at_m| colliders.put(tree(at_m)));
        environment.cover.places_m(Cover::Stone, environment.extent_m).for_each(|at_m| colliders.put(stone(at_m)));
        let posts = scene.race.gates.iter().flat_map(|gate| GatePost::pair(gate, |x, z| environment.height.height_m(x, z)));
        for obstacle in models.into_iter().map(Obstacle::Model).chain(posts.map(Obstacle::Post)) {
            colliders.obstacles.entry(colliders.tile_at(obstacle.at_m())).or_default().push(obstacle);
        }
        colliders
    }

    /// Height of the terrain (m).
    pub fn height_m(&self, at_m: [f32; 2]) -> f32 {
        self.height.height_m(at_m[0], at_m[1])
    }

    /// Slope of the terrain (∂h/∂x, ∂h/∂z).
    pub fn slope(&self, at_m: [f32; 2]) -> [f32; 2] {
        self.height.slope(at_m[0], at_m[1])
    }

    /// Whether there is no tree, stone, model or post within `radius_m`.
    pub fn is_free(&self, at_m: [f32; 2], radius_m: f32) -> bool {
        self.tiles_around(at_m, radius_m + TILE_M.max(self.model_reach_m)).all(|tile| {
            self.obstacles.get(&tile).is_none_or(|obstacles| obstacles.iter().all(|obstacle| obstacle.is_beyond(at_m, radius_m)))
        })
    }

    /// Whether there are no colliders.
    pub fn is_empty(&self) -> bool {
        self.created.is_empty()
    }

    /// Creates the tiles near `objects_m` and removes those far from all.
    pub fn follow(&mut self, objects_m: &[[f32; 2]], physics: &mut PhysicsWorld) {
        let around = |reach_m| objects_m.iter().flat_map(|&at_m| self.tiles_around(at_m, reach_m)).collect::<BTreeSet<_>>();
        let (create, keep) = (around(CREATE_M + self.model_reach_m), around(KEEP_M + self.model_reach_m));
        self.created.retain(|tile, colliders| {
            let stays = keep.contains(tile);
            if !stays {
                for &collider in colliders.iter() {
                    physics.remove_collider(collider);
                }
            }
            stays
        });
        for tile in create {
            if !self.created.contains_key(&tile) {
                let colliders = self.colliders(tile).into_iter().map(|collider| physics.insert_collider(collider, None)).collect();
                self.created.insert(tile, colliders);
            }
        }
    }

    /// The handles of the colliders of each tile.
    pub fn created(&self) -> &BTreeMap<TileIndex, Vec<ColliderHandle>> {
        &self.created
    }

    /// Restores the handles of colliders that are part of a restored physics world.
    pub fn restore(&mut self, created: BTreeMap<TileIndex, Vec<ColliderHandle>>) {
        self.created = created;
    }

    fn put(&mut self, obstacle: Obstacle) {
        let obstacles = self.obstacles.entry(self.tile_at(obstacle.at_m())).or_default();
        if obstacles.len() < OBSTACLES_PER_TILE {
            obstacles.push(obstacle);
        }
    }

    fn tile_at(&self, at_m: [f32; 2]) -> TileIndex {
        std::array::from_fn(|axis| (at_m[axis] / self.tile_m[axis]).floor() as i32)
    }

    fn tiles_around(&self, at_m: [f32; 2], reach_m: f32) -> impl Iterator<Item = TileIndex> + use<> {
        let [x0, z0] = self.tile_at(at_m.map(|m| m - reach_m));
        let [x1, z1] = self.tile_at(at_m.map(|m| m + reach_m));
        (z0..=z1).flat_map(move |z| (x0..=x1).map(move |x| [x, z]))
    }

    fn colliders(&self, tile: TileIndex) -> Vec<ColliderBuilder> {
        let groups = InteractionGroups::new(TERRAIN, Group::ALL, InteractionTestMode::And);
        let mut colliders = vec![self.terrain(tile).collision_groups(groups)];
        colliders.extend(self.obstacles.get(&tile).into_iter().flatten().map(|obstacle| obstacle.collider(&self.height)));
        colliders
    }

    /// The terrain of a tile. The height map is bilinear between pixels, the collider piecewise linear between its nodes. They differ by at most a
    /// quarter of the twist of a cell of the collider.
    fn terrain(&self, tile: TileIndex) -> ColliderBuilder {
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
        // Without this flag a ball that rolls over flat terrain bounces off the edges of the triangles.
        let flags = HeightFieldFlags::FIX_INTERNAL_EDGES;
        ColliderBuilder::heightfield_with_flags(heights, scale, flags).translation(center).friction(0.8)
    }
}

/// Distance between the heights of a tile: a fraction or a multiple of the map's pixels, which keeps the creases of the terrain.
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
    fn nodes_coincide_with_pixels() {
        for pixel_m in [0.01, 0.07, 0.1, 0.5, 1.9, 2.0, 7.3, 75.0] {
            let spacing = spacing_m(pixel_m);
            let ratio = if spacing > pixel_m { spacing / pixel_m } else { pixel_m / spacing };
            assert!((ratio - ratio.round()).abs() < 1e-4, "{pixel_m}: {spacing}");
            assert!((0.0999..=2.0001).contains(&spacing), "{pixel_m}: {spacing}");
        }
    }
}
