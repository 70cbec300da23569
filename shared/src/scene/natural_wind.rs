//! Natural wind as noise (Chen & Johan §5.3, second approach).

use serde::{Deserialize, Serialize};

/// Gusts of noise that push the grass near cameras, in addition to or instead of the simulated wind: Chen & Johan perturb θ and ω by Perlin noise,
/// and the waves propagate it. Patches whose centre is within reach of a camera are awake. Elsewhere one patch of the same gusts
/// [repeats](crate::grass::RepeatedPatch), which pages show and nothing else feels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct NaturalWind {
    /// Largest acceleration of the bend (rad/s²); divided by the stiffness κ it is the bend that a steady push sustains. Default 0, no natural wind;
    /// allowed 0..=20.
    pub strength_rad_per_s2: f32,
    /// Size of a gust (m); after eight of them the pattern repeats. Default 25, allowed 8..=1000.
    pub scale_m: f32,
    /// Velocity of the gusts along X and Z (m/s); the grass bends in that direction. Default (6, 2), allowed −40..=40 each.
    pub drift_m_per_s: [f32; 2],
    /// Largest distance from a camera to the centre of a patch whose grass is pushed (m), Chen & Johan's d. Default 55 (four patches of their size),
    /// allowed 0..=500.
    pub reach_m: f32,
}

impl Default for NaturalWind {
    fn default() -> Self {
        Self { strength_rad_per_s2: 0.0, scale_m: 25.0, drift_m_per_s: [6.0, 2.0], reach_m: 55.0 }
    }
}
