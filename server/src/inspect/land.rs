//! Names of what covers the land.

use prairie_core::scene::Scene;
use prairie_core::terrain::{Cover, CoverMap};
use std::collections::BTreeSet;

/// The IDs of a covering map, ascending, with their names: the scene's species, underbrush and models, and the fixed ones.
pub(super) fn cover_names(scene: &Scene, cover: &CoverMap) -> Vec<(u8, String)> {
    let ids: BTreeSet<u8> = cover.ids().iter().copied().collect();
    ids.into_iter().map(|id| (id, cover_name(scene, id))).collect()
}

fn cover_name(scene: &Scene, id: u8) -> String {
    let species = scene.species.iter().map(|species| (species.cover, &species.name));
    let underbrush = scene.underbrush.iter().map(|underbrush| (underbrush.cover, &underbrush.name));
    let models = scene.models.iter().map(|model| (model.cover, &model.name));
    match Cover::from(id) {
        Cover::Gap => "gap".to_owned(),
        Cover::Tree => "tree".to_owned(),
        Cover::Stone => "stone".to_owned(),
        Cover::Grass => "grass".to_owned(),
        Cover::Free(id) => {
            let named = species.chain(underbrush).chain(models).find(|(cover, _)| *cover == id);
            named.map_or_else(|| format!("bare ground {id}"), |(_, name)| name.clone())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::terrain::grey_png;

    #[test]
    fn every_id_of_the_map_is_named() {
        let scene = crate::scenes::load("meadow").unwrap();
        let names = cover_names(&scene.scene, &scene.cover);
        let name = |id: u8| names.iter().find(|(other, _)| *other == id).map(|(_, name)| name.as_str());
        assert_eq!([name(0), name(253), name(255)], [Some("gap"), Some("tree"), Some("grass")]);
        assert_eq!(name(20), Some("reed"));
        assert!(scene.cover.ids().iter().all(|id| name(*id).is_some()));
        let unknown = CoverMap::from_png(&grey_png([2; 2], &[255, 77, 77, 0])).unwrap();
        assert!(cover_names(&scene.scene, &unknown).contains(&(77, "bare ground 77".to_owned())));
    }
}
