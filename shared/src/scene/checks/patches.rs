//! Checks of the world's size.

use super::Conflicts;
use super::limits::{AWAKE_CELLS_LIMIT, EXTENT_LIMIT_M};
use crate::scene::Scene;

/// Checks the extent of the world and the memory of awake patches.
pub(super) fn check(scene: &Scene, conflicts: &mut Conflicts) {
    let patches = &scene.patches;
    if !patches.cells.is_multiple_of(8) {
        conflicts.note(&["patches.cells"], format!("is {}; allowed: a multiple of 8", patches.cells));
    }
    let [width_m, depth_m] = scene.extent_m();
    if width_m.max(depth_m) > EXTENT_LIMIT_M {
        let message = format!("makes a world of {width_m} m × {depth_m} m; allowed: count × cells × cell_m up to {EXTENT_LIMIT_M} m");
        conflicts.note(&["patches.count", "patches.cells", "patches.cell_m"], message);
    }
    let awake_cells = u64::from(patches.awake_limit) * u64::from(patches.cells) * u64::from(patches.cells);
    if awake_cells > AWAKE_CELLS_LIMIT {
        let message = format!(
            "lets {} patches of {}² cells be awake, {awake_cells} in all; allowed: {AWAKE_CELLS_LIMIT}",
            patches.awake_limit, patches.cells
        );
        conflicts.note(&["patches.awake_limit", "patches.cells"], message);
    }
}
