//! A car that drives itself in circles.

use shared::wire::Drive;

/// Excess of speed from which on a driver brakes, as downhill (m/s).
const BRAKE_BEYOND_M_PER_S: f32 = 0.5;
/// A car slower than this for [`STUCK_SECS`] backs off for [`BACK_SECS`] (m/s, s, s).
const STUCK_M_PER_S: f32 = 0.7;
const STUCK_SECS: f32 = 2.0;
const BACK_SECS: f32 = 1.5;

/// Drives one car.
#[derive(Clone, Copy, Debug)]
pub(super) struct Circling {
    speed_m_per_s: f32,
    steer: f32,
    stuck_secs: f32,
    back_secs: f32,
}

impl Circling {
    /// The driver of the `n`-th car, at a speed; even ones turn right, odd ones left, each on a circle of its own width.
    pub(super) fn new(n: u32, speed_m_per_s: f32) -> Self {
        let width = 0.55 + 0.1 * (n % 5) as f32;
        let steer = if n.is_multiple_of(2) { width } else { -width };
        Self { speed_m_per_s, steer, stuck_secs: 0.0, back_secs: 0.0 }
    }

    /// What its hands do at a speed.
    pub(super) fn hands(&mut self, speed_m_per_s: f32, dt_secs: f32) -> Drive {
        if self.back_secs > 0.0 {
            self.back_secs -= dt_secs;
            return Drive { throttle: -0.8, steer: -self.steer, ..Drive::default() };
        }
        self.stuck_secs = if speed_m_per_s < STUCK_M_PER_S { self.stuck_secs + dt_secs } else { 0.0 };
        if self.stuck_secs > STUCK_SECS {
            (self.stuck_secs, self.back_secs) = (0.0, BACK_SECS);
        }
        let excess_m_per_s = speed_m_per_s - self.speed_m_per_s;
        let throttle = (-0.5 * excess_m_per_s).clamp(0.0, 1.0);
        let brake = (0.2 * (excess_m_per_s - BRAKE_BEYOND_M_PER_S)).clamp(0.0, 1.0);
        Drive { throttle, brake, steer: self.steer, ..Drive::default() }
    }
}
