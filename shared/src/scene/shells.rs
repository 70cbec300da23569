//! Shell rendering of grass: the section `[shells]`.

use super::wind::words;
use serde::{Deserialize, Serialize};

words! {
    /// Direction in which shells are grown out of the ground.
    ShellExtrusion {
        /// Along the normal of the ground (Bakay §3.1, Fig. 3.1).
        Normal = "normal",
        /// Straight up, the constant vector that Bakay §3.1 names as the alternative.
        Up = "up",
    }
}

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
    /// Direction of upright blades: `normal`, along the normal of the ground; `up`, straight up, as grass on slopes grows (Bakay §3.1). The wind acts
    /// at right angles to it. Default `normal`.
    pub extrusion: ShellExtrusion,
    /// Stiffness along a blade, p: segment j of N is tilted by (j/N)^(1 + p) of the tilt of the tip. 0 tilts each segment by the same amount more than
    /// the one below, as Bakay does; larger values are stiff grass, which bends up the stalk, and negative ones are floppy grass, which bends at the
    /// foot (Bakay §3.2). Default 0, allowed −0.9..=4.
    pub stiffness_profile: f32,
}

impl Default for Shells {
    fn default() -> Self {
        Self { layers: 17, slices: 8, blades_per_m2: 5000.0, root_light: 0.25, extrusion: ShellExtrusion::Normal, stiffness_profile: 0.0 }
    }
}
