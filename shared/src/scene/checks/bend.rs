//! Checks of the bend field's scheme.

use super::Conflicts;
use crate::bend::{Scheme, Seams};
use crate::scene::Scene;

/// Checks the requirements of the modal scheme: the build's feature, one constant speed, exact seams, and all patches awake.
pub(super) fn check(scene: &Scene, conflicts: &mut Conflicts) {
    let Scene { bend, grass, patches, species, .. } = scene;
    if bend.scheme != Scheme::Modal {
        return;
    }
    if !cfg!(feature = "modal") {
        let message = "is \"modal\"; allowed in this build: \"verlet\", \"substepped\" or \"implicit\", for it lacks the feature `modal` of prairie-core";
        conflicts.note(&["bend.scheme"], message.to_owned());
        return;
    }
    let scheme = "`bend.scheme` = \"modal\"";
    if grass.waves.mu_m_per_rad != 0.0 {
        let message = format!("is {}; allowed with {scheme}: 0, for its speed is one constant", grass.waves.mu_m_per_rad);
        conflicts.note(&["grass.mu_m_per_rad", "bend.scheme"], message);
    }
    if !species.is_empty() {
        let message = format!("names {} species; allowed with {scheme}: none, for its speed is one constant", species.len());
        conflicts.note(&["species", "bend.scheme"], message);
    }
    if bend.seams != Seams::Exact {
        conflicts.note(&["bend.seams", "bend.scheme"], format!("is \"{}\"; allowed with {scheme}: \"exact\"", bend.seams.word()));
    }
    let count = u64::from(patches.count[0]) * u64::from(patches.count[1]);
    if count > u64::from(patches.awake_limit) {
        let message = format!(
            "is {}; allowed with {scheme}: at least as many as there are patches, {count}, for it carries all of them at once",
            patches.awake_limit
        );
        conflicts.note(&["patches.awake_limit", "patches.count", "bend.scheme"], message);
    }
}
