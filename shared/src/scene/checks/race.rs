//! Checks of the race.

use super::Conflicts;
use crate::scene::{AMBER_SECS, GATES_LIMIT, GREEN_SECS, Scene};

/// Smallest distance between the middles of two gates (m).
const APART_M: f32 = 1.0;

/// Shortest period of the start light (s): amber, green, and as much red as it takes to see it.
const SHORTEST_LIGHT_SECS: f32 = (AMBER_SECS + GREEN_SECS) as f32 + 2.0;

/// Checks the number and the places of the gates, and the light.
pub(super) fn check(scene: &Scene, conflicts: &mut Conflicts) {
    let (race, [width_m, depth_m]) = (&scene.race, scene.extent_m());
    if race.gates.is_empty() {
        return;
    }
    if race.gates.len() == 1 {
        conflicts
            .note(&["race.gates"], format!("has 1 section; allowed: none, or 2 to {GATES_LIMIT}, since a lap leads from gate to gate"));
    }
    let light_secs = race.light_period_secs;
    if light_secs > 0.0 && light_secs < SHORTEST_LIGHT_SECS {
        conflicts.note(&["race.light_period_secs"], format!("is {light_secs}; allowed: 0 for no light, or {SHORTEST_LIGHT_SECS} to 3600"));
    }
    for (i, gate) in race.gates.iter().enumerate() {
        let ([x, z], field) = (gate.at_m, format!("race.gates[{i}].at_m"));
        if x > width_m || z > depth_m {
            let message = format!("is [{x}, {z}]; allowed: within the world, 0 to {width_m} and 0 to {depth_m}");
            conflicts.note(&[&field, "patches.count", "patches.cells", "patches.cell_m"], message);
        }
        let near = race.gates[..i].iter().position(|other| {
            let [away_x, away_z] = [other.at_m[0] - x, other.at_m[1] - z];
            away_x * away_x + away_z * away_z < APART_M * APART_M
        });
        if let Some(other) = near {
            let message = format!("is [{x}, {z}], the place of `race.gates[{other}]`; allowed: at least {APART_M} m from every other gate");
            conflicts.note(&[field, format!("race.gates[{other}].at_m")], message);
        }
    }
}
