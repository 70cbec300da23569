//! Key and gamepad bindings: the action of each key and button.

use crate::controls::Controls;
use crate::vehicle::{Dpad, profile};
use prairie_core::scene::VehicleKind;

/// Effect of a single press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Selects a vehicle, or leaves the current one.
    Take(Option<VehicleKind>),
    /// Takes the next or the previous kind of vehicle.
    TakeNext {
        /// Whether it is the next one.
        forward: bool,
    },
    /// Moves the camera to a height (m) above the ground, or above the vehicle.
    SetHeight(f32),
}

/// Camera heights (m) on the digit keys 1 to 4, by physical key; Zhang, Fig. 23.
pub const HEIGHT_KEYS: [(&str, f32); 4] = [("Digit1", 1.0), ("Digit2", 5.0), ("Digit3", 10.0), ("Digit4", 20.0)];

const NEUTRAL: Controls = Controls { forward: 0.0, turn: 0.0, side: 0.0, rise: 0.0 };

/// Keys that act while they are held, by physical key: those of Zhang, chapter 6, and the arrow keys.
pub const HELD_KEYS: [(&str, Controls); 13] = [
    ("KeyW", Controls { forward: 1.0, ..NEUTRAL }),
    ("ArrowUp", Controls { forward: 1.0, ..NEUTRAL }),
    ("KeyS", Controls { forward: -1.0, ..NEUTRAL }),
    ("ArrowDown", Controls { forward: -1.0, ..NEUTRAL }),
    ("KeyA", Controls { turn: -1.0, ..NEUTRAL }),
    ("ArrowLeft", Controls { turn: -1.0, ..NEUTRAL }),
    ("KeyD", Controls { turn: 1.0, ..NEUTRAL }),
    ("ArrowRight", Controls { turn: 1.0, ..NEUTRAL }),
    ("KeyQ", Controls { side: -1.0, ..NEUTRAL }),
    ("KeyE", Controls { side: 1.0, ..NEUTRAL }),
    ("Space", Controls { rise: 1.0, ..NEUTRAL }),
    ("ShiftLeft", Controls { rise: -1.0, ..NEUTRAL }),
    ("ShiftRight", Controls { rise: -1.0, ..NEUTRAL }),
];

/// Action of a key press: vehicles by letter (`key`), heights by physical key (`code`), since some keyboard layouts have digits only with Shift.
pub fn key_action(key: &str, code: &str) -> Option<Action> {
    let key = key.to_lowercase();
    if matches!(key.as_str(), "f" | "escape") {
        return Some(Action::Take(None));
    }
    let mut letters = key.chars();
    let letter = letters.next().filter(|_| letters.next().is_none());
    let vehicle = VehicleKind::ALL.into_iter().find(|&kind| Some(profile(kind).key) == letter);
    let height = || HEIGHT_KEYS.iter().find(|(known, _)| *known == code).map(|&(_, height_m)| Action::SetHeight(height_m));
    vehicle.map(|kind| Action::Take(Some(kind))).or_else(height)
}

/// Action of a gamepad button in the standard layout (W3C Gamepad, section 11): the D-pad selects a vehicle or leaves it; LB and RB cycle through
/// all of them.
pub fn gamepad_action(button: u32) -> Option<Action> {
    let take =
        |direction| VehicleKind::ALL.into_iter().find(|&kind| profile(kind).dpad == Some(direction)).map(|kind| Action::Take(Some(kind)));
    match button {
        4 => Some(Action::TakeNext { forward: false }),
        5 => Some(Action::TakeNext { forward: true }),
        12 => take(Dpad::Up),
        13 => Some(Action::Take(None)),
        14 => take(Dpad::Left),
        15 => take(Dpad::Right),
        _ => None,
    }
}

/// The next or previous kind of vehicle in [`VehicleKind::ALL`], wrapping around at the ends; without a current vehicle the first or last.
pub fn next_vehicle(current: Option<VehicleKind>, forward: bool) -> VehicleKind {
    let all = VehicleKind::ALL;
    let position = current.and_then(|current| all.iter().position(|kind| *kind == current));
    let next = match (position, forward) {
        (Some(position), true) => position + 1,
        (Some(position), false) => position + all.len() - 1,
        (None, true) => 0,
        (None, false) => all.len() - 1,
    };
    all[next % all.len()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vehicle::VehicleProfile;

    /// Keys of the page (`panel.js`, `sound.js`, `time_bar.js`) and the key that gives a vehicle up.
    const PAGE_KEYS: &str = "gknopvxtr,.f";

    #[test]
    fn letters_take_vehicles_whatever_the_case_and_digits_set_heights() {
        for kind in VehicleKind::ALL {
            let key = profile(kind).key.to_string();
            for key in [key.clone(), key.to_uppercase()] {
                assert_eq!(key_action(&key, ""), Some(Action::Take(Some(kind))));
            }
        }
        assert_eq!(key_action("Escape", "Escape"), Some(Action::Take(None)));
        assert_eq!(key_action("\"", "Digit3"), Some(Action::SetHeight(10.0)));
        assert_eq!([key_action("w", "KeyW"), key_action("Control", "ControlLeft"), key_action("", "")], [None; 3]);
    }

    #[test]
    fn every_vehicle_has_its_own_key_and_direction() {
        let held = HELD_KEYS.iter().filter_map(|(code, _)| code.strip_prefix("Key")?.to_lowercase().chars().next());
        let mut keys: Vec<char> = PAGE_KEYS.chars().chain(held).collect();
        let mut directions = Vec::new();
        for kind in VehicleKind::ALL {
            let VehicleProfile { key, dpad, .. } = profile(kind);
            assert!(key.is_ascii_lowercase() && !keys.contains(&key), "the key of {kind:?} is taken");
            assert!(dpad.is_none_or(|dpad| !directions.contains(&dpad)), "the direction of {kind:?} is taken");
            keys.push(key);
            directions.extend(dpad);
        }
    }

    #[test]
    fn the_cross_takes_the_vehicles_of_the_table() {
        let [up, down, left, right] = [12, 13, 14, 15].map(gamepad_action);
        assert_eq!(
            [up, left, right],
            [VehicleKind::Helicopter, VehicleKind::Car, VehicleKind::Monster].map(|kind| Some(Action::Take(Some(kind))))
        );
        assert_eq!(down, Some(Action::Take(None)));
    }

    #[test]
    fn the_shoulder_buttons_reach_every_vehicle_both_ways() {
        for (button, forward) in [(5, true), (4, false)] {
            assert_eq!(gamepad_action(button), Some(Action::TakeNext { forward }));
            let reached = std::iter::successors(Some(next_vehicle(None, forward)), |kind| Some(next_vehicle(Some(*kind), forward)));
            let reached: Vec<_> = reached.take(VehicleKind::ALL.len()).collect();
            assert!(VehicleKind::ALL.iter().all(|kind| reached.contains(kind)), "{reached:?}");
            assert_eq!(next_vehicle(reached.last().copied(), forward), reached[0]);
        }
        assert_ne!(next_vehicle(Some(VehicleKind::ALL[1]), true), next_vehicle(Some(VehicleKind::ALL[1]), false));
    }
}
