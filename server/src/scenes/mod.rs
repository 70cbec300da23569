//! Scenes: built-in scenes, scene files, and generators of the built-in maps.

mod builtin;
mod catalogue;
mod create;
mod error;
mod explanation;
mod fault_report;
mod load;
mod loaded;

pub mod maps;
mod message;
mod report;

pub use catalogue::{SceneDescription, catalogue, picture};
pub use create::{CreateError, create};
pub use error::{FaultyScene, SceneError};
pub(crate) use explanation::millis;
pub use explanation::{Explanation, ExplanationRow};
#[cfg(test)]
pub(crate) use load::MAP_LIMIT;
pub use load::{load, load_open, most_similar};
pub use loaded::{LoadedScene, OpenScene};
pub use report::{Report, check};

/// Names and summaries of the built-in scenes, the default first.
pub fn list() -> impl Iterator<Item = (&'static str, String)> {
    builtin::BUILT_IN.iter().map(|built_in| (built_in.name, built_in.scene().summary))
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::scene::{FIELDS, parse};
    use prairie_core::terrain::Cover;

    #[test]
    fn built_in_scenes_are_valid_and_send_no_paths() {
        for (name, summary) in list() {
            let loaded = load(name).unwrap_or_else(|error| panic!("{error}"));
            assert!(!summary.is_empty() && loaded.scene.summary == summary && loaded.name == name);
            assert!(loaded.scene.terrain.height_map.is_empty() && loaded.scene.terrain.covering_map.is_empty());
            assert!(loaded.scene.growth.nutrient_map.is_empty() && loaded.scene.underbrush_file.is_empty());
            assert!(check(name).unwrap().to_string().starts_with(&format!("{name}: valid\n")));
        }
        assert_eq!(list().next().unwrap().0, "meadow");
    }

    #[test]
    fn meadow_toml_shows_every_field_and_its_examples_are_valid() {
        let text = builtin::BUILT_IN[0].text;
        for (path, _) in FIELDS {
            let key = path.rsplit('.').next().unwrap();
            let is_shown = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').any(|word| word == key);
            assert!(is_shown, "{path} is not in meadow.toml");
        }
        let is_example = |line: &&str| line.starts_with("[[") || line.split_once(" = ").is_some_and(|(key, _)| !key.contains(' '));
        let shown = text.lines().map(|line| line.strip_prefix("# ").filter(is_example).unwrap_or(line));
        let scene = parse(&shown.collect::<Vec<_>>().join("\n")).unwrap_or_else(|faults| panic!("{faults:?}"));
        let prairie_core::scene::Scene { species, underbrush, models, drawn_winds, .. } = &scene;
        assert_eq!([scene.wind.primitives.len(), species.len(), underbrush.len(), models.len(), drawn_winds.len()], [1; 5]);
        assert_eq!(scene.underbrush[0].components.len(), 1);
    }

    #[test]
    fn stored_maps_equal_the_generated_ones() {
        for map in maps::generate() {
            let stored = std::fs::read(format!("{}/scenes/{}", env!("CARGO_MANIFEST_DIR"), map.name)).unwrap();
            let mut reader = png::Decoder::new(std::io::Cursor::new(stored)).read_info().unwrap();
            assert_eq!([reader.info().width, reader.info().height], map.size_px, "{}", map.name);
            let levels = match map.levels {
                maps::Levels::Eight(levels) => levels,
                maps::Levels::Sixteen(levels) => levels.into_iter().flat_map(u16::to_be_bytes).collect(),
            };
            let mut stored_levels = vec![0; levels.len()];
            reader.next_frame(&mut stored_levels).unwrap();
            assert!(stored_levels == levels, "{} differs; run `prairie maps --out server/scenes`", map.name);
        }
    }

    #[test]
    fn the_continuum_is_rolling_and_has_all_its_grasses() {
        let LoadedScene { scene, height, cover, .. } = load("continuum").unwrap();
        let [side_m, _] = scene.extent_m();
        assert!((side_m - 4828.032).abs() < 0.01 && scene.patches.awake_limit == 225);
        let [low, high] = height.range_m();
        assert!(low > 0.0 && (40.0..90.0).contains(&(high - low)), "{low} to {high}");
        let places = (0..200).flat_map(|row| (0..200).map(move |column| [column, row].map(|n| (n as f32 + 0.5) / 200.0 * side_m)));
        let steepest = places.map(|[x, z]| height.slope(x, z)).map(|[east, south]| east.hypot(south)).fold(0.0, f32::max);
        assert!(steepest < 0.3, "{steepest}");
        for (id, least, most) in [(1, 0.15, 0.4), (2, 0.2, 0.5), (3, 0.003, 0.03), (255, 0.25, 0.5)] {
            let fraction = cover.ids().iter().filter(|&&found| found == id).count() as f32 / cover.ids().len() as f32;
            assert!((least..most).contains(&fraction), "{fraction} of ID {id}");
        }
        assert_eq!(scene.species.iter().map(|species| species.cover).collect::<Vec<_>>(), [1, 2, 3]);
    }

    #[test]
    fn the_meadow_is_open_in_the_middle_and_surrounded_by_hills() {
        let meadow = load("meadow").unwrap();
        let extent_m = meadow.scene.extent_m();
        for cover in [Cover::Tree, Cover::Stone] {
            let places: Vec<_> = meadow.cover.places_m(cover, extent_m).collect();
            assert!((150..=260).contains(&places.len()), "{} of {cover:?}", places.len());
        }
        let from_middle = |[x, z]: [f32; 2]| (x - 128.0).hypot(z - 140.0);
        assert!(meadow.cover.places_m(Cover::Tree, extent_m).all(|at| from_middle(at) > 35.0));
        let height = |x, z| meadow.height.height_m(x, z);
        let [low, high] = meadow.height.range_m();
        assert!((10.0..=25.0).contains(&(high - low)), "{low} to {high}");
        let corners = [height(4.0, 4.0), height(252.0, 4.0), height(4.0, 252.0), height(252.0, 252.0)];
        assert!(corners.iter().all(|&corner| corner > height(128.0, 140.0) + 4.0), "{corners:?}");
    }
}
