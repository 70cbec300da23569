//! Flow primitives that a scene places in its wind.

use super::intensity::PrimitiveIntensity;
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
    /// Factor of its speed and dust, as a function of the time since the start of the world (Bakay §3.2). `steady` is 1; `gust` rises linearly and falls as a
    /// parabola; `cubic` rises and falls by one cubic polynomial each, without a kink; `periodic` is the square of a sine; `spline` goes through
    /// `intensity_points`. At 0 it leaves the air alone, below 0 it blows the other way. Default `steady`.
    pub intensity: PrimitiveIntensity,
    /// Duration of the rise of `gust` and `cubic` from 0 to 1 (s). Default 0, at once; allowed 0..=3600.
    pub attack_secs: f32,
    /// Time for which `gust` and `cubic` stay at 1 (s). Default 0, allowed 0..=3600.
    pub hold_secs: f32,
    /// Duration of the fall of `gust` and `cubic` from 1 to 0 (s). Default 0, at once; allowed 0..=3600. The rise, the time at 1 and the fall may not all be 0.
    pub fall_secs: f32,
    /// Time after which the intensity repeats (s), at least the sum of rise, time at 1 and fall. Default 0, allowed 0..=86400; 0, which `periodic` and `spline` do
    /// not allow, for a `gust` or `cubic` that happens once, at the start of the world.
    pub period_secs: f32,
    /// Points [secs, intensity] of `spline`, 2 or more, ascending in time and before `period_secs`; it is monotone between them. Default none, allowed
    /// 0..=32 points, seconds 0..=86400 and intensity -2..=2.
    pub intensity_points: Vec<[f32; 2]>,
    /// Speed at which the intensity runs away from the centre (m/s): at a distance d it is that of the centre `d / front_m_per_s` ago. Default 0, no delay; allowed
    /// 0..=1000.
    pub front_m_per_s: f32,
    /// Width of the rings around the centre within which the delay is the same (m): the animation steps of Bakay §3.2. Default 0, a continuous delay; allowed
    /// 0..=1000.
    pub step_m: f32,
}

impl Primitive {
    /// A primitive at rest at `at_m` (X, height above the ground, Z), all else by default.
    pub fn new(kind: PrimitiveKind, at_m: [f32; 3]) -> Self {
        Self {
            kind,
            at_m,
            radius_m: 20.0,
            speed_m_per_s: 8.0,
            heading_rad: 0.0,
            drift_m_per_s: [0.0; 2],
            dust: 0.0,
            intensity: PrimitiveIntensity::Steady,
            attack_secs: 0.0,
            hold_secs: 0.0,
            fall_secs: 0.0,
            period_secs: 0.0,
            intensity_points: Vec::new(),
            front_m_per_s: 0.0,
            step_m: 0.0,
        }
    }
}
