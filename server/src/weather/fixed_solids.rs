//! What stands in the wind: land, stones and the crowns of trees.

use super::box_terrain::BoxTerrain;
use prairie_core::scene::{Scene, WindTiling};
use prairie_core::terrain::{Cover, CoverMap, HeightMap};
use prairie_wind::solids::DragBody;
use prairie_wind::{Air, Body, Config, Pressure, SolidError};
use std::f32::consts::FRAC_PI_4;

/// Lower and upper end and diameter of a mean crown, relative to the height of the tree.
const CROWN: [f32; 2] = [0.2, 0.95];
const CROWN_DIAMETER: f32 = 0.35;

/// Height of a stone relative to its width, and its drag coefficient, about that of a ball.
const STONE_HEIGHT: f32 = 0.6;
const STONE_DRAG: f64 = 0.5;

/// Everything in the box of a scene's wind that does not move. What lies beyond a box smaller than the world is left out: the box repeats with its own.
pub(super) struct FixedSolids {
    /// Crowns, and stones that the cells do not resolve.
    drag: Vec<DragBody>,
    /// Stones that the cells resolve.
    pub(super) stones: Vec<Body>,
}

impl FixedSolids {
    pub(super) fn new(scene: &Scene, height: &HeightMap, cover: &CoverMap, terrain: &BoxTerrain) -> Self {
        let place = Place { scene, height, cover, terrain };
        let (stones, small): (Vec<_>, Vec<_>) = place.stones().partition(|stone| stone.is_resolved_by(scene.wind.spacing_m.map(f64::from)));
        Self { drag: place.crowns().chain(small.iter().map(Body::drag)).collect(), stones }
    }

    /// Puts the land and the drag into air at rest. Land that is an obstacle is immersed for the direct pressure solver, and solid cells for others.
    pub(super) fn immerse(&self, air: &mut Air<f32>, config: &Config, terrain: &BoxTerrain, height: &HeightMap) -> Result<(), SolidError> {
        match (terrain.is_solid(), config.pressure) {
            (true, Pressure::Direct) => air.set_walls(|position_m| terrain.distance_m(position_m, height), |_| [0.0; 3])?,
            (true, _) => air.set_solid(|position_m| terrain.contains(position_m, config.spacing_m))?,
            (false, _) => {}
        }
        air.set_drag(&self.drag)
    }
}

/// The scene that solids stand in.
struct Place<'a> {
    scene: &'a Scene,
    height: &'a HeightMap,
    cover: &'a CoverMap,
    terrain: &'a BoxTerrain,
}

impl Place<'_> {
    /// Points on the ground (m, in the box) with one kind of cover.
    fn on_ground(&self, cover: Cover) -> impl Iterator<Item = [f32; 3]> {
        let box_m = self.scene.wind.box_m();
        let places = self.cover.places_m(cover, self.scene.extent_m()).filter(move |[x, z]| *x < box_m[0] && *z < box_m[2]);
        places.map(|[x, z]| {
            let ground_m = self.height.height_m(x, z);
            [x, ground_m - self.terrain.zero_m(ground_m), z]
        })
    }

    /// Crowns of all trees; none without `wind.crown_drag_per_m`.
    fn crowns(&self) -> impl Iterator<Item = DragBody> {
        let (per_m, tree_m) = (self.scene.wind.crown_drag_per_m, self.scene.plants.tree_m);
        let [low_m, high_m] = CROWN.map(|share| share * tree_m);
        let (diameter_m, depth_m) = (CROWN_DIAMETER * tree_m, high_m - low_m);
        let drag_m2 = per_m * FRAC_PI_4 * diameter_m * diameter_m * depth_m;
        let crown = move |[x, ground_m, z]: [f32; 3]| DragBody {
            centre_m: [x, ground_m + low_m + 0.5 * depth_m, z].map(f64::from),
            half_extents_m: [diameter_m, depth_m, diameter_m].map(|side_m| f64::from(0.5 * side_m)),
            velocity_m_per_s: [0.0; 3],
            drag_m2: [drag_m2.into(); 3],
        };
        self.on_ground(Cover::Tree).filter(move |_| per_m > 0.0).map(crown)
    }

    /// All stones; none in a box that is tiled by patch, where they would be in every patch.
    fn stones(&self) -> impl Iterator<Item = Body> {
        let (width_m, is_patch) = (self.scene.plants.stone_m, self.scene.wind.tiling == WindTiling::Patch);
        let height_m = STONE_HEIGHT * width_m;
        let stone = move |[x, ground_m, z]: [f32; 3]| Body {
            centre_m: [x, ground_m + 0.5 * height_m, z].map(f64::from),
            half_extents_m: [width_m, height_m, width_m].map(|side_m| f64::from(0.5 * side_m)),
            axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            velocity_m_per_s: [0.0; 3],
            drag_coefficient: STONE_DRAG,
        };
        self.on_ground(Cover::Stone).filter(move |_| !is_patch).map(stone)
    }
}
