//! Checks of the snow.

use super::Conflicts;
use crate::scene::Snow;

/// Checks that pressed snow is at least as dense as undisturbed snow, and that snow lies where it falls.
pub(super) fn check(snow: &Snow, conflicts: &mut Conflicts) {
    if snow.pressed_density_kg_m3 < snow.density_kg_m3 {
        let message = format!("is {}; allowed: at least `snow.density_kg_m3`, {}", snow.pressed_density_kg_m3, snow.density_kg_m3);
        conflicts.note(&["snow.pressed_density_kg_m3", "snow.density_kg_m3"], message);
    }
    if snow.fall_m_per_h > 0.0 && !snow.lies() {
        let message = format!("is {}; allowed with `snow.depth_m` = 0: 0, for snow falls where it lies", snow.fall_m_per_h);
        conflicts.note(&["snow.fall_m_per_h", "snow.depth_m"], message);
    }
}
