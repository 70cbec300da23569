//! Bending of the grass: the section `[grass]`.

use crate::bend::WaveParams;
use serde::{Deserialize, Serialize};

/// Constants of how a kind of grass bends and rises (Chen & Johan §4.4).
///
/// In a scene file the fields of `waves` are written directly in `[grass]`, and all of this but `laid_recovery_secs` directly in `[[species]]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Grass {
    /// Constants of the wave equations.
    pub waves: WaveParams,
    /// Largest bend on flat land (rad). Default 1.45, allowed 0.1..=1.57.
    pub theta_max_rad: f32,
    /// Bend that a wind of 10 m/s sustains (rad); proportional to the square of the speed below that. Default 0.5, allowed 0..=1.5.
    pub wind_bend_rad: f32,
    /// Delay of the tip's bend behind the root's (s): γ of the topmost segment, Chen & Johan Eq. (7); it grows evenly over the segments below. Default
    /// 0.12, allowed 0..=1.
    pub lag_secs: f32,
    /// Fraction of that delay while the grass rises, when its upper parts trail less (Chen & Johan §4.5). Default 0.4, allowed 0..=1.
    pub recovery_lag_share: f32,
    /// Number of segments that bend one after the other, from the root up; 1 is stiff, short grass that bends as a whole. Default 3, allowed 1..=6.
    pub segments: u32,
    /// Time in which grass flattened by an object's weight rises to 1/e of its lean (s). Default 60, allowed 0.5..=86400.
    pub laid_recovery_secs: f32,
}

impl Default for Grass {
    fn default() -> Self {
        Self {
            waves: WaveParams::default(),
            theta_max_rad: 1.45,
            wind_bend_rad: 0.5,
            lag_secs: 0.12,
            recovery_lag_share: 0.4,
            segments: 3,
            laid_recovery_secs: 60.0,
        }
    }
}
