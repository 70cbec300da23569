//! Maps of the terrain.

use serde::{Deserialize, Serialize};

/// Height map and covering map, with their scales (Zhang §5.5).
///
/// Both are grey PNG files whose row 0 is the northern edge. Pixel centres are `pixel_m` apart, the first at the world's corner. Heights are bilinear
/// between pixels and constant outside the map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TerrainMaps {
    /// PNG of 8 or 16 bits, grey, no alpha; path relative to the scene file. Required.
    pub height_map: String,
    /// 8-bit grey PNG of covering IDs (Zhang Table 2): 0 gap, 253 tree, 254 stone, 255 grass; stretched over the
    /// world; path relative to the scene file. Required.
    pub covering_map: String,
    /// Distance between pixel centres of the height map along X and Z (m); pixels × distance must reach
    /// the world's far edges. Required, allowed 0.01..=1000.
    pub pixel_m: [f32; 2],
    /// Metres per grey level of the height map. Required, allowed 0..=1000.
    pub level_m: f32,
    /// Elevation of grey level 0 (m). Default 0, allowed −12000..=12000.
    #[serde(default)]
    pub base_m: f32,
}
