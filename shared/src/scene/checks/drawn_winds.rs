//! Checks of the drawn winds.

use super::Conflicts;
use crate::scene::Scene;

/// Checks shapes and paths.
pub(super) fn check(scene: &Scene, conflicts: &mut Conflicts) {
    let extent_m = scene.extent_m();
    for (i, wind) in scene.drawn_winds.iter().enumerate() {
        if let Some(message) = wind.shape.fault() {
            conflicts.note(&[&format!("drawn_winds[{i}].shape")], message);
        }
        let outside = wind.path_m.iter().position(|place| (0..2).any(|axis| place[axis] > extent_m[axis]));
        if let Some(at) = outside {
            let ([x, z], [width_m, depth_m]) = (wind.path_m[at], extent_m);
            let message = format!("is [{x}, {z}]; allowed: within the world, 0 to {width_m} and 0 to {depth_m}");
            conflicts.note(&[&format!("drawn_winds[{i}].path_m[{at}]"), "patches.count", "patches.cells", "patches.cell_m"], message);
        }
    }
}
