//! Checks of the tolerances, which are texts with units.

use super::Conflicts;
use crate::scene::Accuracy;

/// Checks that every tolerance is a number with its unit.
pub(super) fn check(accuracy: &Accuracy, conflicts: &mut Conflicts) {
    for (path, message) in accuracy.faults() {
        conflicts.note(&[path], message);
    }
}
