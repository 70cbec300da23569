//! Checks of sun and lamps.

use super::Conflicts;
use crate::scene::{Lamp, Light};

/// Checks the course of the sun.
pub(super) fn check_light(light: &Light, conflicts: &mut Conflicts) {
    if light.day_length_secs > 0.0 && light.hour < 0.0 {
        let message = format!("is {}; allowed without `light.hour`: 0, for the sun stands still", light.day_length_secs);
        conflicts.note(&["light.day_length_secs", "light.hour"], message);
    }
}

/// Checks that every lamp's light is finite.
pub(super) fn check_lamps(lamps: &[Lamp], conflicts: &mut Conflicts) {
    for (i, lamp) in lamps.iter().enumerate() {
        if lamp.attenuation == [0.0; 3] {
            conflicts.note(&[format!("lights[{i}].attenuation")], "is [0, 0, 0]; allowed: at least one term above 0".to_owned());
        }
    }
}
