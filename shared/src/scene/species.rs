//! Species of grass: the sections `[[species]]`.

use super::{Grass, Plants};
use serde::{Deserialize, Serialize};

/// One species of grass: its ID in the covering map, its size, colours and swing, and how it bends. Fields that a section omits are as in `[grass]` and
/// `[plants]`, which describe the grass of ID 255.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Species {
    /// Unique name, not empty. Required.
    pub name: String,
    /// Unique ID in the covering map. Required, allowed 1..=252.
    pub cover: u8,
    /// Mean height of a blade (m). Default 0.8 or as in `[plants]`, allowed 0.02..=5.
    pub height_m: f32,
    /// Colour at the root, linear RGB. Default (0.03, 0.07, 0.015) or as in `[plants]`, allowed 0..=1 each.
    pub root_rgb: [f32; 3],
    /// Colour at the tip, linear RGB. Default (0.3, 0.4, 0.09) or as in `[plants]`, allowed 0..=1 each.
    pub tip_rgb: [f32; 3],
    /// Natural frequency of a blade of mean height (Hz). Default 1.55 or as in `[plants]`, allowed 0.05..=50.
    pub swing_hz: f32,
    /// How it bends; `laid_recovery_secs` is always that of `[grass]`.
    pub grass: Grass,
}

impl Species {
    /// A species that differs from `grass` and `plants` only in its name and ID.
    pub fn new(name: &str, cover: u8, grass: &Grass, plants: &Plants) -> Self {
        Self {
            name: name.to_owned(),
            cover,
            height_m: plants.height_m,
            root_rgb: plants.root_rgb,
            tip_rgb: plants.tip_rgb,
            swing_hz: plants.swing_hz,
            grass: *grass,
        }
    }

    /// The plants of this species: its own size, colours and swing, all else from `base`.
    pub fn plants(&self, base: &Plants) -> Plants {
        Plants { height_m: self.height_m, root_rgb: self.root_rgb, tip_rgb: self.tip_rgb, swing_hz: self.swing_hz, ..*base }
    }
}
