//! Client cameras, near which the grass is simulated first.

use super::vector::squared_distance;
use crate::grid::{PatchIndex, PatchLayout};
use serde::{Deserialize, Serialize};

/// A client's camera.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Number of the client.
    pub client: u32,
    /// Position of the eye (m).
    pub eye_m: [f32; 3],
}

impl Camera {
    /// Position on the ground (m).
    pub fn xz(&self) -> [f32; 2] {
        [self.eye_m[0], self.eye_m[2]]
    }
}

/// Square of the distance (m²) of a patch's centre from the nearest camera, or from the centre of the world when there is no camera.
pub(super) fn nearest_distance2_m2(patch: PatchIndex, layout: &PatchLayout, cameras: &[Camera]) -> f32 {
    let center_m = layout.center_m(patch);
    let nearest = cameras.iter().map(|camera| squared_distance(center_m, camera.xz())).reduce(f32::min);
    nearest.unwrap_or_else(|| squared_distance(center_m, layout.extent_m().map(|extent| 0.5 * extent)))
}
