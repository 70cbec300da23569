//! How grass is drawn as shells.

use serde::{Deserialize, Serialize};

/// Layers of cross-sections that stand for grass (003), where `plants.cover` or a picture's far field asks for them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Shells {
    /// Layers near the camera, the ground among them (003 §4.1); half as many each time the distance doubles. Default 17, allowed 1..=65.
    pub layers: u32,
    /// Most slices between two layers in which a flat view looks for blades, so that it does not see through between them; 1 is 003's own way. Default 8, allowed
    /// 1..=32.
    pub slices: u32,
    /// Blades on a square metre near the camera. Default 5000, allowed 100..=40000.
    pub blades_per_m2: f32,
    /// Least share of the light that reaches the roots, S_min of 003 §3.3.3. Default 0.25, allowed 0..=1.
    pub root_light: f32,
}

impl Default for Shells {
    fn default() -> Self {
        Self { layers: 17, slices: 8, blades_per_m2: 5000.0, root_light: 0.25 }
    }
}
