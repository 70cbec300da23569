//! Where the visitor stands and what light falls on the scene.

use serde::{Deserialize, Serialize};

/// Where a visitor's camera starts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CameraStart {
    /// Place over the ground as a share of the world's extent along X and Z, 0..=1. Default (0.5, 0.62).
    pub at: [f32; 2],
    /// Height above the ground (m). Default 2.2, allowed 0.02..=2000.
    pub height_m: f32,
    /// Heading (rad) from north towards east. Default 0.35.
    pub heading_rad: f32,
    /// Pitch (rad), negative looks down, allowed −1.5..=1.5. Default −0.08.
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
    /// Heading of the sun (rad), from north towards east. Default 0.9.
    pub sun_heading_rad: f32,
    /// Elevation of the sun above the horizon (rad), allowed 0.02..=1.57. Default 0.55.
    pub sun_elevation_rad: f32,
    /// Distance at which haze has taken 63 % of a colour (m), allowed 10..=100000. Default 900.
    pub haze_m: f32,
}

impl Default for Light {
    fn default() -> Self {
        Self { sun_heading_rad: 0.9, sun_elevation_rad: 0.55, haze_m: 900.0 }
    }
}
