//! What hands ask for, whatever they hold, and what it means to a vehicle.

use shared::scene::VehicleKind;
use shared::wire::Drive;

/// What keyboard, gamepad and thumbs ask for together; each −1..=1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Controls {
    /// Forward (+) or backward (−).
    pub forward: f32,
    /// Turn right (+) or left (−).
    pub turn: f32,
    /// Step right (+) or left (−); the free camera only.
    pub side: f32,
    /// Up (+) or down (−); either one brakes what cannot fly.
    pub rise: f32,
}

impl Controls {
    /// Both together, each axis within −1..=1.
    pub fn with(self, other: Self) -> Self {
        let add = |a: f32, b: f32| (a + b).clamp(-1.0, 1.0);
        Self {
            forward: add(self.forward, other.forward),
            turn: add(self.turn, other.turn),
            side: add(self.side, other.side),
            rise: add(self.rise, other.rise),
        }
    }

    /// What these controls ask of a vehicle.
    pub fn drive(self, vehicle: VehicleKind) -> Drive {
        let flies = vehicle == VehicleKind::Helicopter;
        Drive {
            throttle: self.forward,
            steer: self.turn,
            lift: if flies { self.rise } else { 0.0 },
            brake: if flies { 0.0 } else { self.rise.abs() },
        }
    }
}

/// A stick's deflection without the slack of its centre: 0 within `slack`, then straight up to 1 at 1.
pub fn without_slack(deflection: f32, slack: f32) -> f32 {
    let beyond = (deflection.abs() - slack).max(0.0) / (1.0 - slack);
    beyond.min(1.0) * deflection.signum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_hands_stay_within_range() {
        let both =
            Controls { forward: 1.0, turn: -0.7, ..Default::default() }.with(Controls { forward: 0.5, turn: -0.7, rise: 1.0, side: 0.0 });
        assert_eq!(both, Controls { forward: 1.0, turn: -1.0, side: 0.0, rise: 1.0 });
        assert!(VehicleKind::ALL.iter().all(|&kind| both.drive(kind).is_valid()));
    }

    #[test]
    fn rising_brakes_a_car_and_lifts_a_helicopter() {
        let sink = Controls { rise: -1.0, ..Default::default() };
        assert_eq!((sink.drive(VehicleKind::Car).brake, sink.drive(VehicleKind::Car).lift), (1.0, 0.0));
        assert_eq!((sink.drive(VehicleKind::Helicopter).brake, sink.drive(VehicleKind::Helicopter).lift), (0.0, -1.0));
    }

    #[test]
    fn slack_ends_without_a_jump() {
        assert_eq!(without_slack(0.1, 0.12), 0.0);
        assert!(without_slack(-0.121, 0.12).abs() < 0.01);
        assert_eq!(without_slack(-1.0, 0.12), -1.0);
    }
}
