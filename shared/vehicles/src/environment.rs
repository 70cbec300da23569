//! Terrain and bounds within which objects move.

use prairie_core::terrain::{CoverMap, HeightMap};
use std::sync::Arc;

/// Terrain, cover and extent of the world.
pub struct Environment {
    /// Terrain heights.
    pub height: Arc<HeightMap>,
    /// Covering map, with trees, stones and models.
    pub cover: Arc<CoverMap>,
    /// Extent along X and Z (m).
    pub extent_m: [f32; 2],
}

/// Widest margin between objects and the edge of the world (m).
const MARGIN_M: f32 = 4.0;

impl Environment {
    /// Lowest and highest coordinate (m) of an object's centre along X and Z.
    pub fn bounds_m(&self) -> [[f32; 2]; 2] {
        self.extent_m.map(|extent| {
            let margin = MARGIN_M.min(0.25 * extent);
            [margin, extent - margin]
        })
    }
}
