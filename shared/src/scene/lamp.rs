//! Lamps that stand on the land.

use serde::{Deserialize, Serialize};

/// Most lamps of a scene.
pub const LAMPS_LIMIT: usize = 8;

/// A lamp: a point that shines to all sides (003 §3.3.4).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lamp {
    /// X, height above the ground and Z (m). Required, allowed −100000..=100000 each.
    pub at_m: [f32; 3],
    /// Its colour: linear RGB. Default (1, 0.72, 0.42), as of a light bulb; allowed 0..=1 each.
    pub rgb: [f32; 3],
    /// Luminous intensity (cd): a candle has 1, a bulb of 60 W 60, a street lamp 1000. Default 400, allowed 0..=1000000.
    pub candela: f32,
    /// Constant, linear (1/m) and quadratic (1/m²) term, of which illuminance has the reciprocal: [0, 0, 1] is the inverse square of physics. Default
    /// (0, 0, 1), allowed 0..=100 each; not all 0.
    pub attenuation: [f32; 3],
}

impl Lamp {
    /// A lamp at a place: X, height above the ground and Z (m); all else by default.
    pub fn new(at_m: [f32; 3]) -> Self {
        Self { at_m, rgb: [1.0, 0.72, 0.42], candela: 400.0, attenuation: [0.0, 0.0, 1.0] }
    }
}

/// Notes what does not fit together in the lamps of a scene.
pub(super) fn check(lamps: &[Lamp], misfits: &mut super::check::Misfits) {
    for (i, lamp) in lamps.iter().enumerate() {
        if lamp.attenuation == [0.0; 3] {
            misfits.note(&[format!("lights[{i}].attenuation")], "is [0, 0, 0]; allowed: at least one term above 0".to_owned());
        }
    }
}
