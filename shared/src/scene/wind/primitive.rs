//! Flow primitives that a scene places in its wind.

use super::words::words;
use serde::{Deserialize, Serialize};

words! {
    /// Kinds of flow primitive (Wejchert & Haumann, SIGGRAPH 1991).
    PrimitiveKind {
        /// Blows one way.
        Uniform = "uniform",
        /// Blows away from its centre.
        Source = "source",
        /// Draws towards its centre.
        Sink = "sink",
        /// Turns about an upright axis.
        Vortex = "vortex",
        /// A vortex that draws in near the ground and lifts at its heart (001 §5.3).
        Cyclone = "cyclone",
    }
}

/// One flow primitive; all of a scene are superposed and push the wind towards their sum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Primitive {
    /// `uniform` blows one way, `source` away from its centre, `sink` towards it, `vortex` about an upright axis, and `cyclone` is
    /// a vortex that draws in and lifts (Wejchert & Haumann 1991; 001 §5.3). Required.
    pub kind: PrimitiveKind,
    /// Centre: X, height above the ground and Z (m); within the world and the height of the wind's box. Required, allowed
    /// 0..=100000 each.
    pub at_m: [f32; 3],
    /// Radius within which it acts (m). Default 20, allowed 0.1..=100000.
    pub radius_m: f32,
    /// Greatest speed that it gives (m/s). Default 8, allowed 0..=40.
    pub speed_m_per_s: f32,
    /// Heading of `uniform` (rad), from north towards east. Default 0, allowed −6.3..=6.3.
    pub heading_rad: f32,
    /// Velocity at which the centre travels along X and Z (m/s); at the world's edge it comes in again on the other side. Default
    /// (0, 0), allowed −40..=40 each.
    pub drift_m_per_s: [f32; 2],
    /// Share of `wind.dust.release_per_s` that it releases at its centre. Default 0, allowed 0..=1.
    pub dust: f32,
}

impl Primitive {
    /// A primitive at rest at `at_m` (X, height above the ground, Z), all else by default.
    pub fn new(kind: PrimitiveKind, at_m: [f32; 3]) -> Self {
        Self { kind, at_m, radius_m: 20.0, speed_m_per_s: 8.0, heading_rad: 0.0, drift_m_per_s: [0.0; 2], dust: 0.0 }
    }
}
