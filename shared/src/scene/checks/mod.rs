//! Checks of fields against each other; the range of each single field is in [`FIELDS`](super::FIELDS).

mod accuracy;
mod bend;
mod blade_step;
pub(super) mod conflict;
mod drawn_winds;
mod lights;
pub(super) mod limits;
mod models;
mod objects;
mod patches;
mod race;
mod snow;
mod species;
mod underbrush;

pub(super) use conflict::{Conflict, Conflicts};
pub(super) use underbrush::check_species as check_underbrush_species;

use super::{Scene, wind};

/// Checks `scene`, whose first `from_file` species of underbrush come from its underbrush file, and collects every conflict.
pub(super) fn cross_checks(scene: &Scene, from_file: usize) -> Conflicts {
    let mut conflicts = Conflicts::default();
    patches::check(scene, &mut conflicts);
    bend::check(scene, &mut conflicts);
    blade_step::check(scene, &mut conflicts);
    wind::check::check(scene, &mut conflicts);
    snow::check(&scene.snow, &mut conflicts);
    species::check(&scene.species, &mut conflicts);
    underbrush::check(scene, from_file, &mut conflicts);
    models::check(scene, from_file, &mut conflicts);
    objects::check(&scene.objects, &mut conflicts);
    drawn_winds::check(scene, &mut conflicts);
    race::check(scene, &mut conflicts);
    lights::check_light(&scene.light, &mut conflicts);
    lights::check_lamps(&scene.lights, &mut conflicts);
    accuracy::check(&scene.accuracy, &mut conflicts);
    conflicts
}
