//! What stands in the wind: land, stones, the models of the covering map and the crowns of trees.

use super::box_terrain::BoxTerrain;
use prairie_core::scene::{Scene, WindTiling};
use prairie_core::terrain::{Cover, CoverMap, HeightMap, ModelBox, model_boxes};
use prairie_wind::solids::DragBody;
use prairie_wind::{Air, Body, Config, Pressure, Real, SolidError};
use std::f32::consts::FRAC_PI_4;

/// Lower and upper end and diameter of a mean crown, relative to the height of the tree.
const CROWN: [f32; 2] = [0.2, 0.95];
const CROWN_DIAMETER: f32 = 0.35;

/// Height of a stone relative to its width, and its drag coefficient, about that of a ball.
const STONE_HEIGHT: f32 = 0.6;
const STONE_DRAG: f64 = 0.5;

/// Drag coefficient of a model's box, about that of a cube with a face to the wind (Hoerner 1965).
const MODEL_DRAG: f64 = 1.05;

/// Everything in the box of a scene's wind that does not move. What lies beyond a box smaller than the world is left out: the box repeats with its own.
pub(super) struct FixedSolids {
    /// Crowns, and stones and models that the cells do not resolve.
    drag: Vec<DragBody>,
    /// Stones and models that the cells resolve.
    pub(super) bodies: Vec<Body>,
}

impl FixedSolids {
    pub(super) fn new(scene: &Scene, height: &HeightMap, cover: &CoverMap, terrain: &BoxTerrain) -> Self {
        let place = Place { scene, height, cover, terrain };
        let all = place.stones().chain(place.models());
        let (bodies, small): (Vec<_>, Vec<_>) = all.partition(|body| body.is_resolved_by(scene.wind.spacing_m.map(f64::from)));
        Self { drag: place.crowns().chain(small.iter().map(Body::drag)).collect(), bodies }
    }

    /// Puts the land and the drag into air at rest. Land that is an obstacle is immersed for the direct pressure solver, and solid cells for others.
    pub(super) fn immerse<R: Real>(
        &self,
        air: &mut Air<R>,
        config: &Config,
        terrain: &BoxTerrain,
        height: &HeightMap,
    ) -> Result<(), SolidError> {
        match (terrain.is_solid(), config.pressure) {
            (true, Pressure::Direct) => air.set_walls(|position_m| terrain.distance_m(position_m, height), |_| [0.0; 3])?,
            (true, _) => air.set_solid(|at_m| terrain.contains(at_m.map(|m| m.wide() as f32), config.spacing_m))?,
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
        let places = self.cover.places_m(cover, self.scene.extent_m()).filter(|at_m| self.is_in_box(*at_m));
        places.map(|[x, z]| {
            let ground_m = self.height.height_m(x, z);
            [x, ground_m - self.terrain.zero_m(ground_m), z]
        })
    }

    fn is_in_box(&self, [x, z]: [f32; 2]) -> bool {
        let box_m = self.scene.wind.box_m();
        x < box_m[0] && z < box_m[2]
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

    /// The boxes of all models; none in a box that is tiled by patch, as of stones.
    fn models(&self) -> impl Iterator<Item = Body> {
        let is_patch = self.scene.wind.tiling == WindTiling::Patch;
        let boxes = model_boxes(self.scene, self.cover).into_iter().filter(move |own| !is_patch && self.is_in_box(own.at_m));
        boxes.map(|own| self.body(&own)).filter(Body::is_valid)
    }

    fn body(&self, own: &ModelBox) -> Body {
        let ([x, z], [c, s]) = (own.at_m, own.along.map(f64::from));
        let floor_m = own.floor_m(|x, z| self.height.height_m(x, z)) - self.terrain.zero_m(self.height.height_m(x, z));
        Body {
            centre_m: [x, floor_m + own.half_m[1], z].map(f64::from),
            half_extents_m: own.half_m.map(f64::from),
            axes: [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]],
            velocity_m_per_s: [0.0; 3],
            drag_coefficient: MODEL_DRAG,
        }
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
