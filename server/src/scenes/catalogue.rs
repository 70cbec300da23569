//! Descriptions of scenes, for programs and people that choose among them.

use super::builtin::{BUILT_IN, BuiltIn};
use prairie_core::bend::Scheme;
use prairie_core::scene::{
    BladeIntegrator, BladeShape, FlowerShape, LagWay, ObjectContact, PlantCover, PrimitiveIntensity, Scene, TreeShape, WindBoundary,
    WindMethod, WindTerrain, WindTiling,
};
use serde::Serialize;
use std::sync::LazyLock;

/// Description of a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneDescription {
    /// Name by which it is loaded.
    pub name: String,
    /// One line about it.
    pub summary: String,
    /// Extent of the world to the east and to the south (m).
    pub size_m: [f32; 2],
    /// Number of patches to the east and to the south.
    pub patches: [u32; 2],
    /// Files of its maps and species.
    pub maps: Vec<String>,
    /// Features that not every scene has, such as `rain` and `dust`.
    pub shows: Vec<String>,
    /// Methods other than the default ones, with their sources.
    pub methods: Vec<&'static str>,
    /// Path of its picture on a server; `None` for a scene that is not built in.
    pub picture: Option<String>,
}

/// Descriptions of all built-in scenes, the default first.
pub fn catalogue() -> &'static [SceneDescription] {
    static CATALOGUE: LazyLock<Vec<SceneDescription>> = LazyLock::new(|| BUILT_IN.iter().map(describe).collect());
    &CATALOGUE
}

/// Picture of a built-in scene: its starting view as a JPEG file.
pub fn picture(name: &str) -> Option<&'static [u8]> {
    BuiltIn::find(name).map(|scene| scene.picture)
}

fn describe(built_in: &BuiltIn) -> SceneDescription {
    let picture = Some(format!("/api/scenes/{}/picture", built_in.name));
    SceneDescription { picture, ..SceneDescription::of(built_in.name, &built_in.scene()) }
}

impl SceneDescription {
    /// Describes a scene without a picture.
    pub fn of(name: &str, scene: &Scene) -> Self {
        let files = [&scene.terrain.height_map, &scene.terrain.covering_map, &scene.growth.nutrient_map, &scene.underbrush_file];
        Self {
            name: name.to_owned(),
            summary: scene.summary.clone(),
            size_m: scene.extent_m(),
            patches: scene.patches.count,
            maps: files.into_iter().filter(|file| !file.is_empty()).cloned().collect(),
            shows: shown(scene),
            methods: methods(scene),
            picture: None,
        }
    }
}

/// Words for the parts of a scene that not every scene has.
fn shown(scene: &Scene) -> Vec<String> {
    let Scene { wind, objects, rain, snow, .. } = scene;
    let driven = format!("self-driving {}s", objects.self_driving_kind.name());
    let has_underbrush = !scene.underbrush.is_empty() || !scene.underbrush_file.is_empty();
    let parts: [(bool, &str); 15] = [
        (!scene.species.is_empty(), "species of grass"),
        (scene.plants.cover == PlantCover::Shells, "grass drawn as shells"),
        (has_underbrush, "underbrush"),
        (scene.plants.flowers_per_m2 > 0.0, "flowers"),
        (!scene.models.is_empty(), "models on the land"),
        (!wind.primitives.is_empty(), "whirls and jets"),
        (wind.dust.release_per_s > 0.0, "dust"),
        (scene.natural_wind.strength_rad_per_s2 > 0.0, "gusts of noise"),
        (!scene.drawn_winds.is_empty(), "drawn winds"),
        (rain.rate_mm_per_h > 0.0, "rain"),
        (snow.lies(), "snow"),
        (!scene.lights.is_empty(), "lamps"),
        (objects.self_driving > 0, &driven),
        (objects.balls > 0, "balls"),
        (!scene.race.gates.is_empty(), "a race"),
    ];
    parts.into_iter().filter(|(is_shown, _)| *is_shown).map(|(_, word)| word.to_owned()).collect()
}

/// A method with its source, and whether a scene uses it.
type Method = (&'static str, fn(&Scene) -> bool);

/// Methods other than the default ones.
const METHODS: [Method; 23] = [
    ("wind by stable fluids (Stam 1999; Zhang §2.3)", |scene| scene.wind.method == WindMethod::StableFluids),
    ("one box of wind for all patches, at random offsets (Zhang §5.1)", |scene| scene.wind.tiling == WindTiling::Patch),
    ("one box of wind that follows the objects", |scene| scene.wind.tiling == WindTiling::Follow),
    ("land as an obstacle to the wind, immersed at its slope", |scene| scene.wind.terrain == WindTerrain::Obstacle),
    ("wind that enters and leaves (inflow, outflow)", enters_or_leaves),
    ("crowns of trees that slow the wind (Shaw & Schumann 1992)", |scene| scene.wind.crown_drag_per_m > 0.0),
    ("grass that sways back on the wind (Py et al. 2006)", |scene| scene.wind.canopy_frequency_hz > 0.0),
    ("sources of wind whose intensity varies and runs outwards (Bakay 2003, §3.2)", has_fronts),
    ("gusts of Perlin noise (Chen & Johan 2010, §4.2)", |scene| scene.natural_wind.strength_rad_per_s2 > 0.0),
    ("winds drawn as pictures (Chen & Johan 2010, §5.3)", |scene| !scene.drawn_winds.is_empty()),
    ("bend waves by Verlet's scheme (Chen & Johan 2010, §4.4)", |scene| scene.bend.scheme == Scheme::Verlet),
    ("bend waves by an implicit scheme", |scene| scene.bend.scheme == Scheme::Implicit),
    ("bend waves by Fourier modes, exact in time", |scene| scene.bend.scheme == Scheme::Modal),
    ("contact interpolated between corners (Chen & Johan 2010, §6)", |scene| scene.bend.object_contact == ObjectContact::Interpolated),
    ("segments that repeat earlier states (Chen & Johan 2010, Eq. 7)", |scene| scene.plants.lag == LagWay::History),
    ("blades by Verlet's scheme (Zhang, Eq. 7)", |scene| scene.plants.integrator == BladeIntegrator::Verlet),
    ("blades from an alpha texture (Zhang, Fig. 5)", |scene| scene.plants.blade_shape == BladeShape::Textured),
    ("flowers as squares with six textures (Zhang §3.3)", |scene| scene.plants.flower_shape == FlowerShape::Textured),
    ("models that IDs of the covering map name (Zhang, Table 2)", |scene| !scene.models.is_empty()),
    ("snow that wheels and feet press (Sumner et al. 1999)", |scene| scene.snow.lies()),
    ("trees of trunk, limbs and twigs that bend (Runions et al. 2007; Endo et al. 2003)", |scene| {
        scene.plants.tree_shape == TreeShape::Grown
    }),
    ("shells (Bakay 2003)", |scene| scene.plants.cover == PlantCover::Shells),
    ("a race through gates, against a ghost (Chen & Johan 2010, §7)", |scene| !scene.race.gates.is_empty()),
];

/// The methods that a scene uses.
fn methods(scene: &Scene) -> Vec<&'static str> {
    METHODS.iter().filter(|(_, is_used)| is_used(scene)).map(|(words, _)| *words).collect()
}

fn enters_or_leaves(scene: &Scene) -> bool {
    let faces = scene.wind.faces.pairs().concat();
    faces.contains(&WindBoundary::Inflow) || faces.contains(&WindBoundary::Outflow)
}

fn has_fronts(scene: &Scene) -> bool {
    scene.wind.primitives.iter().any(|primitive| primitive.intensity != PrimitiveIntensity::Steady && primitive.front_m_per_s > 0.0)
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
        assert!(meadow.methods.is_empty());
        assert_eq!(continuum.shows, ["species of grass", "flowers", "self-driving cars"]);
        assert_eq!(of("devil").shows, ["flowers", "whirls and jets", "dust"]);
        assert_eq!(of("storm").shows, ["underbrush", "flowers", "rain"]);
        assert_eq!(of("snow").shows, ["underbrush", "snow", "self-driving cars"]);
        assert_eq!(of("breeze").shows, ["flowers", "gusts of noise"]);
        assert_eq!(of("blades").shows, ["flowers", "self-driving monsters"]);
        assert_eq!(of("shells").shows, ["grass drawn as shells", "whirls and jets"]);
        assert_eq!(of("underbrush").shows, ["underbrush", "balls"]);
        assert_eq!(of("night").shows, ["underbrush", "flowers", "lamps"]);
        assert_eq!(of("race").shows, ["flowers", "a race"]);
        assert_eq!(of("homestead").shows, ["flowers", "models on the land", "balls"]);
    }

    /// Grass that acts back on the wind shows its waves only where some eight cells resolve its height, finer than any scene of the size of a meadow.
    const IN_NO_SCENE: [&str; 1] = ["grass that sways back on the wind (Py et al. 2006)"];

    #[test]
    fn all_other_methods_are_one_click_away() {
        let used: Vec<_> = catalogue().iter().flat_map(|scene| scene.methods.iter().copied()).collect();
        for (method, _) in METHODS {
            assert_eq!(used.contains(&method), !IN_NO_SCENE.contains(&method), "{method}");
        }
    }

    #[test]
    fn every_built_in_scene_has_a_small_picture() {
        for scene in catalogue() {
            let jpeg = picture(&scene.name).unwrap();
            assert!(jpeg.starts_with(&[0xff, 0xd8, 0xff]) && jpeg.len() < 20_000, "{}: {} bytes", scene.name, jpeg.len());
        }
        assert!(picture("moon").is_none());
    }
}
