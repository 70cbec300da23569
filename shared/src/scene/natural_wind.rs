//! Natural wind as noise (001 §5.3, second approach).

use serde::{Deserialize, Serialize};

/// Gusts of noise that push the grass near cameras, besides or instead of the wind's own field: 001 perturbs θ and ω by Perlin noise and lets
/// the waves carry it on. Patches whose middle lies within reach of a camera are awake.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct NaturalWind {
    /// Largest acceleration of the bend (rad/s²); over the stiffness κ it is the bend that a steady push holds. Default 0, no such wind; allowed 0..=20.
    pub strength_rad_per_s2: f32,
    /// Size of a gust (m). Default 25, allowed 8..=1000.
    pub scale_m: f32,
    /// How gusts travel along X and Z (m/s); the grass bends that way. Default (6, 2), allowed −40..=40 each.
    pub drift_m_per_s: [f32; 2],
    /// Distance from a camera to the middle of a patch up to which the grass is pushed, 001's d (m). Default 55 (four patches of 001's size), allowed 0..=500.
    pub reach_m: f32,
}

impl Default for NaturalWind {
    fn default() -> Self {
        Self { strength_rad_per_s2: 0.0, scale_m: 25.0, drift_m_per_s: [6.0, 2.0], reach_m: 55.0 }
    }
}
