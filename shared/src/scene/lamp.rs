//! Lamps on the land.

use serde::{Deserialize, Serialize};

/// Largest number of lamps in a scene.
pub const LAMPS_LIMIT: usize = 8;

/// A lamp: a point light that shines in all directions (Bakay §3.3.4).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lamp {
    /// X, height above the ground and Z (m). Required, allowed −100000..=100000 each.
    pub at_m: [f32; 3],
    /// Colour, linear RGB. Default (1, 0.72, 0.42), a light bulb; allowed 0..=1 each.
    pub rgb: [f32; 3],
    /// Luminous intensity (cd): a candle has 1, a 60 W bulb 60, a street lamp 1000. Default 400, allowed 0..=1000000.
    pub candela: f32,
    /// Attenuation: constant, linear (1/m) and quadratic (1/m²) term; illuminance is divided by their sum. [0, 0, 1] is the inverse-square law.
    /// Default (0, 0, 1), allowed 0..=100 each; not all 0.
    pub attenuation: [f32; 3],
}

impl Lamp {
    /// A lamp at X, height above the ground and Z (m), with the defaults of all else.
    pub fn new(at_m: [f32; 3]) -> Self {
        Self { at_m, rgb: [1.0, 0.72, 0.42], candela: 400.0, attenuation: [0.0, 0.0, 1.0] }
    }
}
