//! State of the gusts that the wind's cells do not resolve.

use serde::{Deserialize, Serialize};

/// The part of the [turbulence](crate::wind::Turbulence) that changes with time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TurbulenceState {
    /// Distance by which the wind has carried the gusts, along X and Z (m).
    pub travel_m: [f64; 2],
    /// Integral of the friction velocity over time (m), which turns the waves over.
    pub path_m: f64,
    /// Friction velocity u* (m/s).
    pub friction_m_per_s: f32,
}

impl TurbulenceState {
    /// The state at a `fraction` of the time from this state to the `next`.
    pub fn towards(&self, next: &Self, fraction: f64) -> Self {
        let between = |from: f64, to: f64| from + (to - from) * fraction;
        Self {
            travel_m: [0, 1].map(|axis| between(self.travel_m[axis], next.travel_m[axis])),
            path_m: between(self.path_m, next.path_m),
            friction_m_per_s: between(self.friction_m_per_s.into(), next.friction_m_per_s.into()) as f32,
        }
    }

    /// Whether every number is finite, as of a valid message.
    pub fn is_finite(&self) -> bool {
        self.travel_m.iter().chain([&self.path_m]).all(|m| m.is_finite()) && self.friction_m_per_s.is_finite()
    }
}
