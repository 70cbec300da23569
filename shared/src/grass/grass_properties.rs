//! Grass properties that limit contact, by position.

use crate::scene::Scene;
use crate::terrain::{CoverMap, KindMap};

/// Largest bend and height of the grass at each position.
#[derive(Clone, Debug)]
pub struct GrassProperties {
    kinds: KindMap,
    /// Largest bend on flat terrain (rad) and mean height (m) of each kind.
    limits: Vec<(f32, f32)>,
}

impl GrassProperties {
    /// The kinds of grass of a scene over its covering map.
    pub fn new(scene: &Scene, cover: &CoverMap) -> Self {
        let limits = scene.kinds().into_iter().zip(scene.kinds_of_plants()).map(|(grass, plants)| (grass.theta_max_rad, plants.height_m));
        Self { kinds: KindMap::new(scene, cover), limits: limits.collect() }
    }

    fn at(&self, [x_m, z_m]: [f32; 2]) -> (f32, f32) {
        self.limits[usize::from(self.kinds.at(x_m, z_m))]
    }

    /// Largest bend (rad) on flat terrain of the grass at a position.
    pub fn theta_max_rad(&self, at_m: [f32; 2]) -> f32 {
        self.at(at_m).0
    }

    /// Mean height (m) of the grass at a position.
    pub fn blade_height_m(&self, at_m: [f32; 2]) -> f32 {
        self.at(at_m).1
    }
}
