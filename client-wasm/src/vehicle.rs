//! Vehicle kinds as the client presents them: one table of names, keys, controls and camera positions.
//!
//! A new [`VehicleKind`] needs one more arm in [`profile`]; the page's buttons and help are generated from it. Its model is in
//! a file of its own in `render/solids/vehicles/`.

use prairie_core::scene::VehicleKind;

/// How the client offers one kind of vehicle to the user.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VehicleProfile {
    /// Label of the page's button.
    pub label: &'static str,
    /// Letter key that selects this kind, lower case. Must differ from the keys of other vehicles and of the page (`a d e f k n o p q s v w x`).
    pub key: char,
    /// Direction of the gamepad's cross that selects this kind; `None` for none. Down is reserved for leaving the vehicle.
    pub dpad: Option<Dpad>,
    /// Position of the chase camera when the user enters the vehicle.
    pub chase: ChaseOffset,
    /// Effect of the up and down controls.
    pub vertical: VerticalControl,
    /// Source of the vehicle's heading.
    pub heading: HeadingSource,
    /// Sound of its engine, if it has one.
    pub engine: Option<Engine>,
    /// Whether parts move even while the vehicle stands still, so that every frame has to be drawn.
    pub moves_at_rest: bool,
}

/// A direction of the gamepad's cross (directional pad).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dpad {
    /// Up.
    Up,
    /// Left.
    Left,
    /// Right.
    Right,
}

impl Dpad {
    /// Arrow for the page's help.
    pub fn arrow(self) -> char {
        match self {
            Self::Up => '↑',
            Self::Left => '←',
            Self::Right => '→',
        }
    }
}

/// Position of a chase camera relative to the vehicle's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChaseOffset {
    /// Horizontal distance behind the centre (m).
    pub distance_m: f32,
    /// Height above the centre (m).
    pub height_m: f32,
}

/// Sound of an engine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Engine {
    /// Pitch at rest (Hz).
    pub idle_hz: f32,
    /// Rise of the pitch with the speed (Hz per m/s).
    pub hz_per_m_per_s: f32,
    /// Beats of the rotor (Hz); 0 for none.
    pub beat_hz: f32,
}

/// Effect of the up and down controls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VerticalControl {
    /// Climb and sink.
    Lift,
    /// Both act as a brake.
    Brake,
    /// Jump and run.
    Jump,
}

/// Source of a vehicle's heading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeadingSource {
    /// The body's orientation.
    Rotation,
    /// The pose's `part_rad`, for a body that rolls.
    PartAngle,
}

/// Entry of a kind. A kind without an entry does not compile.
pub fn profile(kind: VehicleKind) -> VehicleProfile {
    let car = VehicleProfile {
        label: "Car",
        key: 'c',
        dpad: Some(Dpad::Left),
        chase: ChaseOffset { distance_m: 8.0, height_m: 2.8 },
        vertical: VerticalControl::Brake,
        heading: HeadingSource::Rotation,
        engine: Some(Engine { idle_hz: 42.0, hz_per_m_per_s: 5.0, beat_hz: 0.0 }),
        moves_at_rest: false,
    };
    match kind {
        VehicleKind::Car => car,
        VehicleKind::Monster => VehicleProfile {
            label: "Monster",
            key: 'm',
            dpad: Some(Dpad::Right),
            chase: ChaseOffset { distance_m: 5.0, height_m: 2.0 },
            engine: Some(Engine { idle_hz: 28.0, hz_per_m_per_s: 3.0, beat_hz: 0.0 }),
            ..car
        },
        VehicleKind::Helicopter => VehicleProfile {
            label: "Helicopter",
            key: 'h',
            dpad: Some(Dpad::Up),
            chase: ChaseOffset { distance_m: 15.0, height_m: 4.5 },
            vertical: VerticalControl::Lift,
            engine: Some(Engine { idle_hz: 88.0, hz_per_m_per_s: 0.6, beat_hz: 11.0 }),
            moves_at_rest: true,
            ..car
        },
        VehicleKind::Sled => {
            let chase = ChaseOffset { distance_m: 10.0, height_m: 4.0 };
            VehicleProfile { label: "Sled", key: 'l', dpad: None, chase, engine: None, ..car }
        }
        VehicleKind::Ball => VehicleProfile {
            label: "Ball",
            key: 'b',
            dpad: None,
            chase: ChaseOffset { distance_m: 7.0, height_m: 2.4 },
            heading: HeadingSource::PartAngle,
            engine: None,
            ..car
        },
        VehicleKind::Walker => VehicleProfile {
            label: "Walker",
            key: 'j',
            dpad: None,
            chase: ChaseOffset { distance_m: 3.2, height_m: 1.1 },
            vertical: VerticalControl::Jump,
            engine: None,
            ..car
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_chase_camera_is_behind_and_above() {
        for kind in VehicleKind::ALL {
            let ChaseOffset { distance_m, height_m } = profile(kind).chase;
            assert!(distance_m > height_m && height_m > 0.0, "{kind:?}");
        }
    }
}
