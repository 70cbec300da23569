//! The scenes that ship inside the program.

use shared::scene::{Scene, parse};
use shared::terrain::HeightMap;

/// A scene whose files are part of the program.
pub(super) struct BuiltIn {
    pub(super) name: &'static str,
    pub(super) text: &'static str,
    files: &'static [(&'static str, &'static [u8])],
}

macro_rules! file {
    ($name:literal) => {
        ($name, include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/", $name)).as_slice())
    };
}

/// All of them, the default first.
pub(super) const BUILT_IN: [BuiltIn; 8] = [
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
];

impl BuiltIn {
    pub(super) fn find(name: &str) -> Option<&'static Self> {
        BUILT_IN.iter().find(|scene| scene.name == name)
    }

    /// Bytes of a file that the scene names.
    pub(super) fn file(&self, name: &str) -> Option<&'static [u8]> {
        self.files.iter().find(|(known, _)| *known == name).map(|&(_, bytes)| bytes)
    }

    /// The scene; a test holds that every built-in one is sound.
    pub(super) fn scene(&self) -> Scene {
        parse(self.text).unwrap_or_else(|faults| panic!("built-in scene `{}`: {faults:?}", self.name))
    }
}

/// Elevations and extent of the world (m) of `jacksboro`, which its covering map is made from.
pub(super) fn jacksboro_land() -> (HeightMap, [f32; 2]) {
    let [_, jacksboro, ..] = &BUILT_IN;
    let scene = jacksboro.scene();
    let png = jacksboro.file(&scene.terrain.height_map).expect("the scene names a file that ships with it");
    (HeightMap::from_png(png, &scene.terrain).expect("the elevations are a grey PNG"), scene.extent_m())
}
