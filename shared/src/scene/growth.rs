//! Soil of the underbrush, and the sites of its plants (Endo et al. 2003, §5.2).

use serde::{Deserialize, Serialize};

/// Soil and sites of the underbrush.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Growth {
    /// PNG file of the soil's nutrients, stretched over the world: 8-bit grey for all three nutrients alike, or 8-bit RGB for one each, no alpha, at
    /// most 8192 pixels a side, which take 67 MB (grey) or 201 MB (RGB) until growth is complete; path relative to the scene file; empty: they are
    /// generated from the seed. Default empty.
    pub nutrient_map: String,
    /// Mean concentration of the three nutrients, if generated. Default (0.5, 0.5, 0.5), allowed 0..=1 each.
    pub richness: [f32; 3],
    /// Size of rich and poor areas, if generated (m). Default 30, allowed 1..=1000.
    pub patch_m: f32,
    /// Distance between plant sites (m); each is at random within its square. Default 0.5, allowed 0.05..=20, and at most 4194304 sites over the
    /// world if there is underbrush.
    pub spacing_m: f32,
    /// Fraction of daylight that a plant takes from one half its height at the distance of `room_m`. Default 0.5, allowed 0..=1.
    pub shade: f32,
}

impl Default for Growth {
    fn default() -> Self {
        Self { nutrient_map: String::new(), richness: [0.5; 3], patch_m: 30.0, spacing_m: 0.5, shade: 0.5 }
    }
}

impl Growth {
    /// Number of sites along X and Z of a world of `extent_m`: one per square of `spacing_m`.
    pub fn sites(&self, extent_m: [f32; 2]) -> [u32; 2] {
        extent_m.map(|extent_m| (f64::from(extent_m) / f64::from(self.spacing_m)).ceil() as u32)
    }
}
