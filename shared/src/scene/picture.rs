//! Where the visitor stands and what light falls on the scene.

use serde::{Deserialize, Serialize};

/// Where a visitor's camera starts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CameraStart {
    /// Place over the ground as a share of the world's extent along X and Z. Default (0.5, 0.62), allowed
    /// 0..=1 each.
    pub at: [f32; 2],
    /// Height above the ground (m). Default 2.2, allowed 0.02..=2000.
    pub height_m: f32,
    /// Heading (rad) from north towards east. Default 0.35, allowed −6.3..=6.3.
    pub heading_rad: f32,
    /// Pitch (rad), negative looks down. Default −0.08, allowed −1.5..=1.5.
    pub pitch_rad: f32,
}

impl Default for CameraStart {
    fn default() -> Self {
        Self { at: [0.5, 0.62], height_m: 2.2, heading_rad: 0.35, pitch_rad: -0.08 }
    }
}

/// Sun, sky and haze.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Light {
    /// Heading of the sun (rad), from north towards east. Default 0.9, allowed −6.3..=6.3.
    pub sun_heading_rad: f32,
    /// Elevation of the sun above the horizon (rad). Default 0.55, allowed 0.02..=1.57.
    pub sun_elevation_rad: f32,
    /// Distance at which haze has taken 63 % of a colour (m). Default 900, allowed 10..=100000.
    pub haze_m: f32,
}

impl Default for Light {
    fn default() -> Self {
        Self { sun_heading_rad: 0.9, sun_elevation_rad: 0.55, haze_m: 900.0 }
    }
}
