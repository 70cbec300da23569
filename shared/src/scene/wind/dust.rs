//! Dust in the air.

use super::WindAdvection;
use serde::{Deserialize, Serialize};

/// Dust or seed carried by the wind. Its density follows `∂ρ/∂t = −(u·∇)ρ + κ∇²ρ − settling·ρ + release` (Zhang §2.3).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct WindDust {
    /// Rate at which gusts, and primitives with `dust = 1`, add dust at their centre (1/s). Default 0, clear air; allowed 0..=100.
    pub release_per_s: f32,
    /// Rate at which dust settles out of the air (1/s). Default 0.1, allowed 0..=100.
    pub settling_per_s: f32,
    /// Diffusivity κ (m²/s). Default 0.2, allowed 0..=100.
    pub diffusivity_m2_per_s: f32,
    /// Advection scheme of the dust. Default `conservative`; only `semi-lagrangian` with the method `stable-fluids`.
    pub advection: WindAdvection,
}

impl Default for WindDust {
    fn default() -> Self {
        Self { release_per_s: 0.0, settling_per_s: 0.1, diffusivity_m2_per_s: 0.2, advection: WindAdvection::Conservative }
    }
}
