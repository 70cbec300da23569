//! Models that the covering map places: the sections `[[models]]`.

use serde::{Deserialize, Serialize};

/// Largest number of models of a scene.
pub const MODELS_LIMIT: usize = 8;

/// Shortest and longest side of a model's box at its mean size (m).
pub const MODEL_SIDE_M: [f32; 2] = [0.05, 30.0];

/// A model that stands wherever the covering map has its ID (Zhang §5.5.2): a house, a fence, a rock. Each pixel of the ID places one, unless
/// `apart_m` thins them out. Vehicles and the wind meet the box around it, and no plant grows beneath it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CoverModel {
    /// Unique name, not empty. Required.
    pub name: String,
    /// Unique ID in the covering map, also among the species of grass and underbrush. Required, allowed 1..=252.
    pub cover: u8,
    /// `house`, `fence` or `rock` for a built-in model; or a glTF file (`.glb` or `.gltf`; at most 32 MiB, 8192 vertices and 49152 indices), relative to
    /// the scene file; not empty. Required.
    pub model: String,
    /// Width, height and depth of its box (m). The model is stretched to it; sides of 0 keep the proportions to the others, and with three of 0 the
    /// model has its own size, in a glTF file in metres. The result is at least 0.05 and at most 30 on each side. Default (0, 0, 0), allowed
    /// 0..=30 each.
    pub size_m: [f32; 3],
    /// Random variation of the size, plus or minus, as a fraction. Default 0, allowed 0..=0.5.
    pub size_variation: f32,
    /// Direction that its front faces (rad), from north towards east. A glTF model's front faces +Z in its file. Default 0, allowed −6.3..=6.3.
    pub heading_rad: f32,
    /// Random variation of the direction, plus or minus (rad). Default 0, allowed 0..=3.15.
    pub heading_variation_rad: f32,
    /// Smallest distance between two of it (m): of nearer pixels, the first counts, row by row from the north-west; 0: every pixel counts. Default 0,
    /// allowed 0..=1000.
    pub apart_m: f32,
}

impl CoverModel {
    /// A model of its own size that faces north, one at each pixel of the ID `cover`.
    pub fn new(name: &str, cover: u8, model: &str) -> Self {
        Self {
            name: name.to_owned(),
            cover,
            model: model.to_owned(),
            size_m: [0.0; 3],
            size_variation: 0.0,
            heading_rad: 0.0,
            heading_variation_rad: 0.0,
            apart_m: 0.0,
        }
    }
}
