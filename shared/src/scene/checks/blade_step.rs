//! Checks that the blades' integrator is stable within few steps.

use super::Conflicts;
use crate::scene::Scene;
use crate::scene::blade_step::BLADE_STEPS_LIMIT;

/// Rejects blades that would need too many steps.
pub(super) fn check(scene: &Scene, conflicts: &mut Conflicts) {
    for kind in 0..=scene.species.len() {
        let steps = (1.0 / 60.0 / scene.kind_step_secs(kind)).ceil();
        if steps <= BLADE_STEPS_LIMIT as f32 {
            continue;
        }
        let (swing_hz, whose) = match kind.checked_sub(1) {
            None => ("plants.swing_hz".to_owned(), String::new()),
            Some(i) => (format!("species[{i}].swing_hz"), format!(" of \"{}\"", scene.species[i].name)),
        };
        let message = format!(
            "is \"{}\", for which the shortest blades{whose} take {steps} steps in 1/60 s; allowed: {BLADE_STEPS_LIMIT}, by a lower `{swing_hz}`, other damping \
             or less variation of heights, or \"exact\"",
            scene.plants.integrator.word()
        );
        conflicts.note(&["plants.integrator", &swing_hz, "plants.swing_damping", "plants.height_variation"], message);
    }
}
