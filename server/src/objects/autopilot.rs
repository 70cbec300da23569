//! Autopilot: drives a vehicle in circles.

use prairie_core::wire::Drive;
use serde::{Deserialize, Serialize};

/// Excess speed above which the autopilot brakes, for example downhill (m/s).
const BRAKE_BEYOND_M_PER_S: f32 = 0.5;
/// A vehicle slower than this (m/s) for [`STUCK_SECS`] reverses for [`REVERSE_SECS`].
const STUCK_M_PER_S: f32 = 0.7;
const STUCK_SECS: f32 = 2.0;
const REVERSE_SECS: f32 = 1.5;

/// Driver of one vehicle.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Autopilot {
    speed_m_per_s: f32,
    steer: f32,
    stuck_secs: f32,
    reverse_secs: f32,
}

impl Autopilot {
    /// The driver of the `n`-th vehicle. Even numbers turn right, odd ones left, on circles of five sizes.
    pub(super) fn new(n: u32, speed_m_per_s: f32) -> Self {
        let width = 0.55 + 0.1 * (n % 5) as f32;
        let steer = if n.is_multiple_of(2) { width } else { -width };
        Self { speed_m_per_s, steer, stuck_secs: 0.0, reverse_secs: 0.0 }
    }

    /// Input at the present speed.
    pub(super) fn drive(&mut self, speed_m_per_s: f32, dt_secs: f32) -> Drive {
        if self.reverse_secs > 0.0 {
            self.reverse_secs -= dt_secs;
            return Drive { throttle: -0.8, steer: -self.steer, ..Drive::default() };
        }
        self.stuck_secs = if speed_m_per_s < STUCK_M_PER_S { self.stuck_secs + dt_secs } else { 0.0 };
        if self.stuck_secs > STUCK_SECS {
            (self.stuck_secs, self.reverse_secs) = (0.0, REVERSE_SECS);
        }
        let excess_m_per_s = speed_m_per_s - self.speed_m_per_s;
        let throttle = (-0.5 * excess_m_per_s).clamp(0.0, 1.0);
        let brake = (0.2 * (excess_m_per_s - BRAKE_BEYOND_M_PER_S)).clamp(0.0, 1.0);
        Drive { throttle, brake, steer: self.steer, ..Drive::default() }
    }
}
