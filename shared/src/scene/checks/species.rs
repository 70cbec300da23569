//! Checks of the grass species against each other.

use super::Conflicts;
use crate::scene::Species;

/// Checks that no two species share a name or an ID.
pub(super) fn check(species: &[Species], conflicts: &mut Conflicts) {
    for (i, later) in species.iter().enumerate() {
        let earlier = || species[..i].iter().enumerate();
        if let Some((j, _)) = earlier().find(|(_, earlier)| earlier.name == later.name) {
            let fields = [format!("species[{i}].name"), format!("species[{j}].name")];
            conflicts.note(&fields, format!("is \"{}\", already used by `species[{j}]`; allowed: a unique name", later.name));
        }
        if let Some((j, _)) = earlier().find(|(_, earlier)| earlier.cover == later.cover) {
            let fields = [format!("species[{i}].cover"), format!("species[{j}].cover")];
            let message =
                format!("is {}, already used by `species[{j}]`, \"{}\"; allowed: a unique ID, 1 to 252", later.cover, species[j].name);
            conflicts.note(&fields, message);
        }
    }
}
