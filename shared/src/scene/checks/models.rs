//! Checks of the models of the covering map against each other and against the species.

use super::Conflicts;
use crate::scene::Scene;

/// Checks that each model names a file or a built-in model, and that no two share a name, and no two things an ID.
pub(super) fn check(scene: &Scene, from_file: usize, conflicts: &mut Conflicts) {
    let Scene { models, species, underbrush, .. } = scene;
    for (i, model) in models.iter().enumerate() {
        let field = |key: &str| format!("models[{i}].{key}");
        if let Some(j) = models[..i].iter().position(|earlier| earlier.name == model.name) {
            let message = format!("is \"{}\", already used by `models[{j}]`; allowed: a unique name", model.name);
            conflicts.note(&[field("name"), format!("models[{j}].name")], message);
        }
        let grass = species.iter().enumerate().map(|(j, species)| (species.cover, format!("species[{j}]"), &species.name, true));
        let painted = underbrush.iter().enumerate().map(|(j, species)| {
            let own = j.checked_sub(from_file).map(|own| format!("underbrush[{own}]"));
            let is_here = own.is_some();
            (species.cover, own.unwrap_or_else(|| format!("underbrush[{j}]")), &species.name, is_here)
        });
        let earlier = models[..i].iter().enumerate().map(|(j, earlier)| (earlier.cover, format!("models[{j}]"), &earlier.name, true));
        if let Some((cover, path, name, is_here)) = grass.chain(painted).chain(earlier).find(|(cover, ..)| *cover == model.cover) {
            let place = if is_here { "" } else { " in `underbrush_file`" };
            let message = format!("is {cover}, already used by `{path}`{place}, \"{name}\"; allowed: a unique ID, 1 to 252");
            let other = is_here.then(|| format!("{path}.cover"));
            conflicts.note(&std::iter::once(field("cover")).chain(other).collect::<Vec<_>>(), message);
        }
    }
}
