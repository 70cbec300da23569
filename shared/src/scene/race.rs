//! A race over the land: its gates, its laps, and the period of its start light.

use serde::{Deserialize, Serialize};

/// Largest number of gates of a race.
pub const GATES_LIMIT: usize = 32;
/// Time for which the start light is amber before it turns green (s).
pub const AMBER_SECS: f64 = 3.0;
/// Time for which the start light is green (s).
pub const GREEN_SECS: f64 = 10.0;

/// A race: a circuit of gates that vehicles pass in order. A scene without gates has none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Race {
    /// Laps of a race. Default 3, allowed 1..=99.
    pub laps: u32,
    /// Period of the start light (s): red, amber for 3 s, then green for 10 s, at which the period begins; 0 for no light. Default 60, allowed
    /// 0..=3600; with gates 0 or at least 15.
    pub light_period_secs: f32,
    /// Gates in the order in which they are passed, each a section `[[race.gates]]`; the first is start and finish. Default none, allowed at most 32,
    /// and not a single one.
    pub gates: Vec<RaceGate>,
}

impl Default for Race {
    fn default() -> Self {
        Self { laps: 3, light_period_secs: 60.0, gates: Vec::new() }
    }
}

/// A gate: a line on the ground that is passed in one direction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RaceGate {
    /// X and Z of its middle (m), within the world and at least 1 m from those of the others. Required, allowed 0..=100000 each.
    pub at_m: [f32; 2],
    /// Heading (rad), from north towards east, in which it is passed. Required, allowed −6.3..=6.3.
    pub heading_rad: f32,
    /// Distance between its posts (m), which stand at its ends and which vehicles run into. Default 10, allowed 6..=100.
    pub width_m: f32,
}

impl RaceGate {
    /// A gate at X and Z (m) that is passed in the direction of `heading_rad`, with the default width.
    pub fn new(at_m: [f32; 2], heading_rad: f32) -> Self {
        Self { at_m, heading_rad, width_m: 10.0 }
    }
}
