//! The built-in scenes, embedded in the program.

use prairie_core::scene::{Scene, parse};
use prairie_core::terrain::HeightMap;

/// A scene whose files are embedded in the program.
pub(super) struct BuiltIn {
    pub(super) name: &'static str,
    pub(super) text: &'static str,
    /// The files that it names, with their contents.
    pub(super) files: &'static [(&'static str, &'static [u8])],
    /// Its starting view, a JPEG of 256 × 144 px, drawn by the command in `docs/develop.md`.
    pub(super) picture: &'static [u8],
}

/// A built-in scene with its text, the files that it names, and its picture.
macro_rules! scene {
    ($name:literal, $($file:literal),+) => {
        BuiltIn {
            name: $name,
            text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/", $name, ".toml")),
            files: &[$(($file, include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/", $file)).as_slice())),+],
            picture: include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/pictures/", $name, ".jpg")),
        }
    };
}

/// All built-in scenes, the default first.
pub(super) const BUILT_IN: [BuiltIn; 21] = [
    scene!("meadow", "meadow-height.png", "meadow-reeds-covering.png", "species.toml"),
    scene!("jacksboro", "jacksboro-height.png", "jacksboro-covering.png"),
    scene!("devil", "meadow-height.png", "meadow-covering.png"),
    scene!("storm", "meadow-height.png", "meadow-reeds-covering.png", "species.toml"),
    scene!("breeze", "meadow-height.png", "meadow-covering.png"),
    scene!("continuum", "continuum-height.png", "continuum-covering.png"),
    scene!("underbrush", "meadow-height.png", "underbrush-covering.png", "species.toml"),
    scene!("blades", "blades-height.png", "blades-covering.png"),
    scene!("shells", "shells-height.png", "shells-covering.png"),
    scene!("night", "meadow-height.png", "meadow-reeds-covering.png", "species.toml"),
    scene!("lee", "meadow-height.png", "meadow-covering.png"),
    scene!("cyclones", "meadow-height.png", "meadow-covering.png"),
    scene!("follow", "continuum-height.png", "meadow-covering.png"),
    scene!("prairie-2000", "blades-height.png", "blades-covering.png"),
    scene!("verlet", "blades-height.png", "blades-covering.png"),
    scene!("implicit", "blades-height.png", "blades-covering.png"),
    scene!("modal", "blades-height.png", "blades-covering.png"),
    scene!("history", "blades-height.png", "blades-covering.png"),
    scene!("snow", "meadow-height.png", "meadow-reeds-covering.png", "species.toml"),
    scene!("race", "meadow-height.png", "meadow-covering.png"),
    scene!("homestead", "blades-height.png", "homestead-covering.png"),
];

impl BuiltIn {
    pub(super) fn find(name: &str) -> Option<&'static Self> {
        BUILT_IN.iter().find(|scene| scene.name == name)
    }

    /// Names of all built-in scenes.
    pub(super) fn names() -> Vec<&'static str> {
        BUILT_IN.iter().map(|scene| scene.name).collect()
    }

    /// Contents of a file named by the scene.
    pub(super) fn file(&self, name: &str) -> Option<&'static [u8]> {
        self.files.iter().find(|(known, _)| *known == name).map(|&(_, bytes)| bytes)
    }

    /// The parsed scene; a test checks that every built-in scene is valid.
    pub(super) fn scene(&self) -> Scene {
        parse(self.text).unwrap_or_else(|faults| panic!("built-in scene `{}`: {faults:?}", self.name))
    }
}

/// Height map and extent of the world (m) of `jacksboro`, from which its covering map is generated.
pub(super) fn jacksboro_terrain() -> (HeightMap, [f32; 2]) {
    let [_, jacksboro, ..] = &BUILT_IN;
    let scene = jacksboro.scene();
    let png = jacksboro.file(&scene.terrain.height_map).expect("the height map is embedded");
    (HeightMap::from_png(png, &scene.terrain).expect("the elevations are a grey PNG"), scene.extent_m())
}
