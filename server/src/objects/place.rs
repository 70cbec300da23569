//! Where the objects live.

use shared::terrain::{CoverMap, HeightMap};
use std::sync::Arc;

/// The world as objects know it: its land, what stands on it, its extent.
pub struct Place {
    /// Heights of the land.
    pub height: Arc<HeightMap>,
    /// What covers it.
    pub cover: Arc<CoverMap>,
    /// Extent along X and Z (m).
    pub extent_m: [f32; 2],
}

/// Widest margin that objects keep from the world's edge (m).
const MARGIN_M: f32 = 4.0;

impl Place {
    /// Lowest and highest coordinate that an object's centre may have along each axis (m).
    pub fn bounds_m(&self) -> [[f32; 2]; 2] {
        self.extent_m.map(|extent| {
            let margin = MARGIN_M.min(0.25 * extent);
            [margin, extent - margin]
        })
    }
}
