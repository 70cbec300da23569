//! Checks of the objects.

use super::Conflicts;
use crate::outline;
use crate::scene::Objects;

/// Checks counts against the limit, the sled's outline and the wash of helicopters.
pub(super) fn check(objects: &Objects, conflicts: &mut Conflicts) {
    if objects.self_driving > objects.limit {
        let message = format!("is {}; allowed: up to `objects.limit`, {}", objects.self_driving, objects.limit);
        conflicts.note(&["objects.self_driving", "objects.limit"], message);
    }
    let room = objects.limit.saturating_sub(objects.self_driving);
    if objects.balls > room {
        let message = format!("is {}; allowed: up to `objects.limit` less `objects.self_driving`, {room}", objects.balls);
        conflicts.note(&["objects.balls", "objects.limit", "objects.self_driving"], message);
    }
    if let Err(fault) = outline::check(&objects.sled_outline_m) {
        conflicts.note(&["objects.sled_outline_m"], fault.to_string());
    }
    if let Some(message) = objects.helicopter.wash_shape.fault() {
        conflicts.note(&["objects.helicopter.wash_shape"], message);
    }
}
