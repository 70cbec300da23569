//! Critically damped smoothing: the fastest approach to a goal without overshoot.

use std::f32::consts::{PI, TAU};

/// A value that follows a goal like a critically damped spring: `x − goal = (A + B·t)·e^(−t/τ)`. The closed form is stable for any step and gives the same
/// path at any frame rate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Damped {
    /// Current value.
    pub value: f32,
    rate: f32,
}

impl Damped {
    /// A follower at rest at `value`.
    pub fn at(value: f32) -> Self {
        Self { value, rate: 0.0 }
    }

    /// Advances by `dt_secs` towards `goal` with time constant `tau_secs` (τ > 0) and returns the new value.
    pub fn follow(&mut self, goal: f32, tau_secs: f32, dt_secs: f32) -> f32 {
        let a = self.value - goal;
        let b = self.rate + a / tau_secs;
        let decay = (-dt_secs / tau_secs).exp();
        let distance = (a + b * dt_secs) * decay;
        self.value = goal + distance;
        self.rate = b * decay - distance / tau_secs;
        self.value
    }

    /// [`follow`](Self::follow) for an angle (rad), along the shorter arc.
    pub fn follow_angle(&mut self, goal_rad: f32, tau_secs: f32, dt_secs: f32) -> f32 {
        let goal_rad = self.value + wrap_angle(goal_rad - self.value);
        self.follow(goal_rad, tau_secs, dt_secs)
    }
}

/// Wraps an angle to −π..=π (rad). An angle in that range is returned unchanged, bit for bit.
pub fn wrap_angle(angle_rad: f32) -> f32 {
    if angle_rad.abs() <= PI { angle_rad } else { (angle_rad + PI).rem_euclid(TAU) - PI }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_frame_rate_gives_the_same_path() {
        let (mut fine, mut coarse) = (Damped::at(3.0), Damped::at(3.0));
        for _ in 0..100 {
            fine.follow(-1.0, 0.3, 0.01);
        }
        for _ in 0..4 {
            coarse.follow(-1.0, 0.3, 0.25);
        }
        assert!((fine.value - coarse.value).abs() < 1e-5 && (fine.rate - coarse.rate).abs() < 1e-4);
    }

    #[test]
    fn it_reaches_the_goal_without_overshoot() {
        let mut damped = Damped::at(1.0);
        for _ in 0..300 {
            assert!(damped.follow(0.0, 0.2, 0.01) >= 0.0);
        }
        assert!(damped.value < 1e-4);
    }

    #[test]
    fn an_angle_takes_the_shorter_arc() {
        let mut damped = Damped::at(3.0);
        assert!(damped.follow_angle(-3.0, 0.2, 0.1) > 3.0);
        assert!((wrap_angle(7.0) - (7.0 - TAU)).abs() < 1e-6);
    }
}
