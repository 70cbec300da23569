//! Drag of the crowns of trees.

use super::box_terrain::BoxTerrain;
use prairie_core::scene::Scene;
use prairie_core::terrain::{Cover, CoverMap, HeightMap};
use prairie_wind::solids::DragBody;
use std::f32::consts::FRAC_PI_4;

/// Lower and upper end and diameter of a mean crown, relative to the height of the tree.
const CROWN: [f32; 2] = [0.2, 0.95];
const CROWN_DIAMETER: f32 = 0.35;

/// Crowns of all trees of `scene` as bodies of the wind's box; none without `wind.crown_drag_per_m`. Trees beyond a box smaller than the world are left out: the
/// box repeats with its own.
pub(super) fn drag_bodies(scene: &Scene, height: &HeightMap, cover: &CoverMap, terrain: &BoxTerrain) -> Vec<DragBody> {
    let (wind, tree_m) = (&scene.wind, scene.plants.tree_m);
    if wind.crown_drag_per_m == 0.0 {
        return Vec::new();
    }
    let box_m = [0, 2].map(|axis| wind.cells[axis] as f32 * wind.spacing_m[axis]);
    let [low_m, high_m] = CROWN.map(|share| share * tree_m);
    let (diameter_m, depth_m) = (CROWN_DIAMETER * tree_m, high_m - low_m);
    let drag_m2 = wind.crown_drag_per_m * FRAC_PI_4 * diameter_m * diameter_m * depth_m;
    let crown = |[x, z]: [f32; 2]| {
        let ground_m = height.height_m(x, z);
        let centre_m = [x, ground_m - terrain.zero_m(ground_m) + low_m + 0.5 * depth_m, z];
        DragBody {
            centre_m: centre_m.map(f64::from),
            half_extents_m: [diameter_m, depth_m, diameter_m].map(|side_m| f64::from(0.5 * side_m)),
            velocity_m_per_s: [0.0; 3],
            drag_m2: [drag_m2.into(); 3],
        }
    };
    let trees = cover.places_m(Cover::Tree, scene.extent_m());
    trees.filter(|at_m| (0..2).all(|axis| at_m[axis] < box_m[axis])).map(crown).collect()
}
