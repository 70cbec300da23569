//! What the underbrush grows on: soil, and the sites that plants may take (004 §5.2).

use serde::{Deserialize, Serialize};

/// Soil and sites of the underbrush.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Growth {
    /// PNG file that holds the soil's nutrients, stretched over the world: grey of 8 bits for all three alike, or RGB of 8 bits for one each, no alpha, at
    /// most 8192 pixels a side, which take 67 MB grey and 201 MB RGB until all has grown; path relative to the scene file; empty: they are generated from the seed. Default empty.
    pub nutrient_map: String,
    /// Mean concentration of the three nutrients where they are generated. Default (0.5, 0.5, 0.5), allowed 0..=1 each.
    pub richness: [f32; 3],
    /// Size of rich and poor places where they are generated (m). Default 30, allowed 1..=1000.
    pub patch_m: f32,
    /// Distance between the sites that a plant may take (m); each lies at random within its square. Default 0.5, allowed 0.05..=20, and at most 4194304
    /// sites over the world where there is underbrush.
    pub spacing_m: f32,
    /// Share of daylight that a plant takes from one half its height that stands as near as it keeps from its own species. Default 0.5, allowed 0..=1.
    pub shade: f32,
}

impl Default for Growth {
    fn default() -> Self {
        Self { nutrient_map: String::new(), richness: [0.5; 3], patch_m: 30.0, spacing_m: 0.5, shade: 0.5 }
    }
}

impl Growth {
    /// Sites along X and Z of a world of `extent_m`: one for each square of `spacing_m`.
    pub fn sites(&self, extent_m: [f32; 2]) -> [u32; 2] {
        extent_m.map(|extent_m| (f64::from(extent_m) / f64::from(self.spacing_m)).ceil() as u32)
    }
}
