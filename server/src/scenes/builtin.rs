//! The built-in scenes, embedded in the program.

use prairie_core::scene::{Scene, parse};
use prairie_core::terrain::HeightMap;

/// A scene whose files are embedded in the program.
pub(super) struct BuiltIn {
    pub(super) name: &'static str,
    pub(super) text: &'static str,
    /// The files that it names, with their contents.
    pub(super) files: &'static [(&'static str, &'static [u8])],
}

macro_rules! file {
    ($name:literal) => {
        ($name, include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/", $name)).as_slice())
    };
}

/// All built-in scenes, the default first.
pub(super) const BUILT_IN: [BuiltIn; 10] = [
    BuiltIn {
        name: "meadow",
        text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/meadow.toml")),
        files: &[file!("meadow-height.png"), file!("meadow-reeds-covering.png"), file!("species.toml")],
    },
    BuiltIn {
        name: "jacksboro",
        text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/jacksboro.toml")),
        files: &[file!("jacksboro-height.png"), file!("jacksboro-covering.png")],
    },
    BuiltIn {
        name: "devil",
        text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/devil.toml")),
        files: &[file!("meadow-height.png"), file!("meadow-covering.png")],
    },
    BuiltIn {
        name: "storm",
        text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/storm.toml")),
        files: &[file!("meadow-height.png"), file!("meadow-reeds-covering.png"), file!("species.toml")],
    },
    BuiltIn {
        name: "breeze",
        text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/breeze.toml")),
        files: &[file!("meadow-height.png"), file!("meadow-covering.png")],
    },
    BuiltIn {
        name: "continuum",
        text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/continuum.toml")),
        files: &[file!("continuum-height.png"), file!("continuum-covering.png")],
    },
    BuiltIn {
        name: "underbrush",
        text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/underbrush.toml")),
        files: &[file!("meadow-height.png"), file!("underbrush-covering.png"), file!("species.toml")],
    },
    BuiltIn {
        name: "blades",
        text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/blades.toml")),
        files: &[file!("blades-height.png"), file!("blades-covering.png")],
    },
    BuiltIn {
        name: "shells",
        text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/shells.toml")),
        files: &[file!("shells-height.png"), file!("shells-covering.png")],
    },
    BuiltIn {
        name: "race",
        text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/race.toml")),
        files: &[file!("meadow-height.png"), file!("meadow-covering.png")],
    },
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
