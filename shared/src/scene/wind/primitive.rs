//! Flow primitives that a scene places in its wind.

use super::words::words;
use serde::{Deserialize, Serialize};

words! {
    /// Kinds of flow primitive (Wejchert & Haumann 1991).
    PrimitiveKind {
        /// Blows in one direction.
        Uniform = "uniform",
        /// Blows away from its centre.
        Source = "source",
        /// Blows towards its centre.
        Sink = "sink",
        /// Rotates about a vertical axis.
        Vortex = "vortex",
        /// A vortex with inflow near the ground and an updraught in its core (Chen & Johan §5.3).
        Cyclone = "cyclone",
    }
}

/// A flow primitive. Those of a scene are superposed and drive the wind towards their sum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Primitive {
    /// `uniform` blows in one direction, `source` away from its centre, `sink` towards it, `vortex` about a vertical axis, and `cyclone`
    /// is a vortex with inflow and updraught (Wejchert & Haumann 1991; Chen & Johan §5.3). Required.
    pub kind: PrimitiveKind,
    /// Centre: X, height above the ground and Z (m); within the world and the height of the wind's box. Required, allowed
    /// 0..=100000 each.
    pub at_m: [f32; 3],
    /// Radius within which it acts (m). Default 20, allowed 0.1..=100000.
    pub radius_m: f32,
    /// Maximum speed (m/s). Default 8, allowed 0..=40.
    pub speed_m_per_s: f32,
    /// Heading of `uniform` (rad), from north towards east. Default 0, allowed −6.3..=6.3.
    pub heading_rad: f32,
    /// Velocity at which the centre travels along X and Z (m/s); at the edge of the world it re-enters on the other side. Default
    /// (0, 0), allowed −40..=40 each.
    pub drift_m_per_s: [f32; 2],
    /// Dust that it releases at its centre, relative to `wind.dust.release_per_s`. Default 0, allowed 0..=1.
    pub dust: f32,
}

impl Primitive {
    /// A primitive at rest at `at_m` (X, height above the ground, Z), all else by default.
    pub fn new(kind: PrimitiveKind, at_m: [f32; 3]) -> Self {
        Self { kind, at_m, radius_m: 20.0, speed_m_per_s: 8.0, heading_rad: 0.0, drift_m_per_s: [0.0; 2], dust: 0.0 }
    }
}
