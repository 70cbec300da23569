//! Shell rendering of grass: the section `[shells]`.

use serde::{Deserialize, Serialize};

/// Cross-section layers that replace blades of grass (Bakay), where `plants.cover` or the render options ask for them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Shells {
    /// Number of layers near the camera, including the ground (Bakay §4.1); it halves each time the distance doubles. Default 17, allowed 1..=65.
    pub layers: u32,
    /// Largest number of slices searched for blades between two layers in a grazing view, so that it does not see through the gaps; 1 is Bakay's
    /// original method. Default 8, allowed 1..=32.
    pub slices: u32,
    /// Blades per square metre near the camera. Default 5000, allowed 100..=40000.
    pub blades_per_m2: f32,
    /// Smallest fraction of the light that reaches the roots, S_min of Bakay §3.3.3. Default 0.25, allowed 0..=1.
    pub root_light: f32,
}

impl Default for Shells {
    fn default() -> Self {
        Self { layers: 17, slices: 8, blades_per_m2: 5000.0, root_light: 0.25 }
    }
}
