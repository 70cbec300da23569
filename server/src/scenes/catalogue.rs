//! Descriptions of the built-in scenes, for programs that choose among them.

use super::builtin::{BUILT_IN, BuiltIn};
use prairie_core::scene::{PlantCover, Scene};
use serde::Serialize;

/// Description of a built-in scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BuiltInScene {
    /// Name by which it is loaded.
    pub name: &'static str,
    /// One line about it.
    pub summary: String,
    /// Extent of the world to the east and to the south (m).
    pub size_m: [f32; 2],
    /// Number of patches to the east and to the south.
    pub patches: [u32; 2],
    /// Files of its maps and species.
    pub maps: Vec<String>,
    /// Features used, such as `rain` and `dust`.
    pub shows: Vec<String>,
}

/// Describes every built-in scene, the default first.
pub fn catalogue() -> Vec<BuiltInScene> {
    BUILT_IN.iter().map(describe).collect()
}

fn describe(built_in: &BuiltIn) -> BuiltInScene {
    let scene = built_in.scene();
    let files = [&scene.terrain.height_map, &scene.terrain.covering_map, &scene.growth.nutrient_map, &scene.underbrush_file];
    BuiltInScene {
        name: built_in.name,
        size_m: scene.extent_m(),
        patches: scene.patches.count,
        maps: files.into_iter().filter(|file| !file.is_empty()).cloned().collect(),
        shows: shown(&scene),
        summary: scene.summary,
    }
}

/// Words for the parts of a scene that not every scene has.
fn shown(scene: &Scene) -> Vec<String> {
    let Scene { wind, objects, rain, .. } = scene;
    let driven = format!("self-driving {}s", objects.self_driving_kind.name());
    let has_underbrush = !scene.underbrush.is_empty() || !scene.underbrush_file.is_empty();
    let parts: [(bool, &str); 13] = [
        (!scene.species.is_empty(), "species of grass"),
        (scene.plants.cover == PlantCover::Shells, "grass drawn as shells"),
        (has_underbrush, "underbrush"),
        (scene.plants.flowers_per_m2 > 0.0, "flowers"),
        (!wind.primitives.is_empty(), "whirls and jets"),
        (wind.dust.release_per_s > 0.0, "dust"),
        (scene.natural_wind.strength_rad_per_s2 > 0.0, "gusts of noise"),
        (!scene.drawn_winds.is_empty(), "drawn winds"),
        (rain.rate_mm_per_h > 0.0, "rain"),
        (!scene.lights.is_empty(), "lamps"),
        (objects.self_driving > 0, &driven),
        (objects.balls > 0, "balls"),
        (!scene.race.gates.is_empty(), "a race"),
    ];
    parts.into_iter().filter(|(is_shown, _)| *is_shown).map(|(_, word)| word.to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_is_described_by_its_file() {
        let scenes = catalogue();
        assert_eq!(scenes.len(), BUILT_IN.len());
        let of = |name: &str| scenes.iter().find(|scene| scene.name == name).unwrap();
        let (meadow, continuum) = (of("meadow"), of("continuum"));
        assert_eq!((meadow.size_m, meadow.patches), ([256.0; 2], [16; 2]));
        assert_eq!(meadow.maps, ["meadow-height.png", "meadow-reeds-covering.png", "species.toml"]);
        assert_eq!(meadow.shows, ["underbrush", "flowers"]);
        assert_eq!(continuum.shows, ["species of grass", "flowers", "self-driving cars"]);
        assert_eq!(of("devil").shows, ["flowers", "whirls and jets", "dust"]);
        assert_eq!(of("storm").shows, ["underbrush", "flowers", "rain"]);
        assert_eq!(of("breeze").shows, ["flowers", "gusts of noise"]);
        assert_eq!(of("blades").shows, ["flowers", "self-driving monsters"]);
        assert_eq!(of("shells").shows, ["grass drawn as shells"]);
        assert_eq!(of("underbrush").shows, ["underbrush", "balls"]);
        assert_eq!(of("race").shows, ["flowers", "a race"]);
    }
}
