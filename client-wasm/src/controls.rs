//! Control input of any device, and its meaning for a vehicle.

use crate::vehicle::{VerticalControl, profile};
use prairie_core::scene::VehicleKind;
use prairie_core::wire::Drive;

/// Combined input of keyboard, gamepad and touch; each axis −1..=1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Controls {
    /// Forward (+) or backward (−).
    pub forward: f32,
    /// Turn right (+) or left (−).
    pub turn: f32,
    /// Step right (+) or left (−); the free camera only.
    pub side: f32,
    /// Up (+) or down (−); a walker jumps and runs, and all other vehicles that cannot fly brake.
    pub rise: f32,
}

impl Controls {
    /// Sum of both, each axis clamped to −1..=1.
    pub fn with(self, other: Self) -> Self {
        let add = |a: f32, b: f32| (a + b).clamp(-1.0, 1.0);
        Self {
            forward: add(self.forward, other.forward),
            turn: add(self.turn, other.turn),
            side: add(self.side, other.side),
            rise: add(self.rise, other.rise),
        }
    }

    /// Driving commands for a vehicle.
    pub fn drive(self, vehicle: VehicleKind) -> Drive {
        let (lift, brake) = match profile(vehicle).vertical {
            VerticalControl::Lift | VerticalControl::Jump => (self.rise, 0.0),
            VerticalControl::Brake => (0.0, self.rise.abs()),
        };
        Drive { throttle: self.forward, steer: self.turn, lift, brake }
    }
}

/// Deflection of a stick with its dead zone removed: 0 within `dead_zone`, then linear up to 1 at full deflection.
pub fn without_dead_zone(deflection: f32, dead_zone: f32) -> f32 {
    let beyond = (deflection.abs() - dead_zone).max(0.0) / (1.0 - dead_zone);
    beyond.min(1.0) * deflection.signum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn combined_input_stays_within_range() {
        let both =
            Controls { forward: 1.0, turn: -0.7, ..Default::default() }.with(Controls { forward: 0.5, turn: -0.7, rise: 1.0, side: 0.0 });
        assert_eq!(both, Controls { forward: 1.0, turn: -1.0, side: 0.0, rise: 1.0 });
        assert!(VehicleKind::ALL.iter().all(|&kind| both.drive(kind).is_valid()));
    }

    #[test]
    fn up_and_down_brake_a_car_and_lift_a_helicopter() {
        let sink = Controls { rise: -1.0, ..Default::default() };
        assert_eq!((sink.drive(VehicleKind::Car).brake, sink.drive(VehicleKind::Car).lift), (1.0, 0.0));
        assert_eq!((sink.drive(VehicleKind::Helicopter).brake, sink.drive(VehicleKind::Helicopter).lift), (0.0, -1.0));
        assert_eq!((sink.drive(VehicleKind::Walker).brake, sink.drive(VehicleKind::Walker).lift), (0.0, -1.0), "it runs");
    }

    #[test]
    fn the_dead_zone_ends_without_a_jump() {
        assert_eq!(without_dead_zone(0.1, 0.12), 0.0);
        assert!(without_dead_zone(-0.121, 0.12).abs() < 0.01);
        assert_eq!(without_dead_zone(-1.0, 0.12), -1.0);
    }
}
