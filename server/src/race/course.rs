//! The course of a race, as a step needs it.

use super::driven_motion::DrivenMotion;
use prairie_core::race::{GateLine, LightColor, StartLight};
use prairie_core::scene::Scene;

/// Depth of the place behind the first gate where vehicles wait for the start light (m).
const GRID_M: f64 = 20.0;
/// Poses of a track in a second (Hz).
const TRACK_HZ: f32 = 10.0;
/// Speed below which a vehicle waits (m/s).
const WAITING_M_PER_S: f64 = 0.5;

/// The gates and the start light, with the step of the world.
pub(super) struct Course {
    pub(super) gates: Vec<GateLine>,
    pub(super) laps: u32,
    pub(super) light: Option<StartLight>,
    /// Steps from one pose of a track to the next.
    pub(super) track_period: u64,
    dt_secs: f64,
}

impl Course {
    /// The course of a scene; `None` if it has no gates.
    pub(super) fn new(scene: &Scene) -> Option<Self> {
        let gates: Vec<_> = scene.race.gates.iter().map(GateLine::new).collect();
        (!gates.is_empty()).then(|| Self {
            gates,
            laps: scene.race.laps,
            light: StartLight::of(scene),
            track_period: (scene.tick_hz / TRACK_HZ).round().max(1.0) as u64,
            dt_secs: f64::from(scene.dt_secs()),
        })
    }

    /// Simulated time (s) at a fraction of step `tick`, 0 at its start.
    pub(super) fn secs(&self, tick: u64, share: f64) -> f64 {
        (tick.saturating_sub(1) as f64 + share) * self.dt_secs
    }

    /// Whether a step begins in the place where vehicles wait for the light.
    pub(super) fn is_on_grid(&self, motion: &DrivenMotion) -> bool {
        let [ahead_m, right_m] = self.gates[0].from_gate_m(motion.from.xz());
        (-GRID_M..0.0).contains(&ahead_m) && right_m.abs() <= self.gates[0].half_width_m()
    }

    /// Whether a vehicle stands.
    pub(super) fn is_waiting(&self, motion: &DrivenMotion) -> bool {
        let [x_m, z_m] = [0, 2].map(|axis| f64::from(motion.to.position_m[axis]) - f64::from(motion.from.position_m[axis]));
        let most_m = WAITING_M_PER_S * self.dt_secs;
        x_m * x_m + z_m * z_m < most_m * most_m
    }

    /// Moment (s) at which the light turned green, if it was green at `secs` in step `tick`.
    pub(super) fn green_secs(&self, tick: u64, secs: f64) -> Option<f64> {
        let light = self.light.filter(|light| light.color(tick) == LightColor::Green)?;
        Some(light.newest_green(tick) as f64 * self.dt_secs).filter(|green_secs| *green_secs <= secs)
    }
}
