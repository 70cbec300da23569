//! A scene: everything that a scene file (TOML) can say, each constant with its meaning, unit, default and range.
//!
//! A scene file needs only what differs from the defaults; the shortest one names its maps. Parsing and the checks of
//! ranges are the first thing done with a file; the world is made from a checked [`Scene`] alone.

mod allowed;
mod bend;
mod check;
mod drawn_wind;
mod fault;
mod grass;
mod growth;
mod lamp;
mod natural_wind;
mod objects;
mod parse;
mod patches;
mod picture;
mod plants;
mod rain;
mod shells;
mod species;
mod swing;
mod template;
mod terrain;
mod underbrush;
mod walk;
mod wind;

pub use allowed::{Allowed, FIELDS, REQUIRED};
pub use bend::BendField;
pub use check::{AWAKE_CELLS_LIMIT, EXTENT_LIMIT_M, WIND_CELLS_LIMIT};
pub use drawn_wind::{DrawnWind, WindShape};
pub use fault::SceneFault;
pub use grass::Grass;
pub use growth::Growth;
pub use lamp::{LAMPS_LIMIT, Lamp};
pub use natural_wind::NaturalWind;
pub use objects::{BallTread, CarTread, HelicopterTread, MonsterTread, Objects, SledTread, Tread, VehicleKind};
pub use parse::{parse, parse_underbrush, parse_with};
pub use patches::Patches;
pub use picture::{CameraStart, Light};
pub use plants::{BladeIntegrator, BladeShape, LagWay, PlantCover, Plants};
pub use rain::Rain;
pub use shells::Shells;
pub use species::Species;
pub use swing::BLADE_STEPS_LIMIT;
pub use terrain::TerrainMaps;
pub use underbrush::{COMPONENTS_LIMIT, Component, ComponentKind, PARTS_LIMIT, SITES_LIMIT, SPECIES_LIMIT, Underbrush};
pub(crate) use wind::words;
pub use wind::{
    Primitive, PrimitiveKind, Wind, WindAdvection, WindBoundary, WindDiffusion, WindDust, WindFaces, WindMethod, WindPressure, WindTerrain,
    WindTiling, WindTime,
};

use serde::{Deserialize, Serialize};

/// A whole scene, as a scene file describes it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// One line that says what the scene shows; `prairie scenes` prints it. Required.
    pub summary: String,
    /// Seed of everything random in the scene: placing of plants, sources of the wind. Default 1, allowed
    /// 0..=9223372036854775807.
    #[serde(default = "default_seed")]
    pub seed: u64,
    /// Fixed steps of the world per second (Hz). Default 60, allowed 10..=240.
    #[serde(default = "default_tick_hz")]
    pub tick_hz: f32,
    /// The extent of the world, in patches of cells of the bend field.
    #[serde(default)]
    pub patches: Patches,
    /// Height map and covering map with their scales.
    pub terrain: TerrainMaps,
    /// The wind: its box, what drives it, and how it is solved.
    #[serde(default)]
    pub wind: Wind,
    /// Gusts of noise that push the grass near cameras (001 §5.3).
    #[serde(default)]
    pub natural_wind: NaturalWind,
    /// Rain that beats on the plants.
    #[serde(default)]
    pub rain: Rain,
    /// How the bend field is solved.
    #[serde(default)]
    pub bend: BendField,
    /// How the grass bends and rises: the constants of the bend field.
    #[serde(default)]
    pub grass: Grass,
    /// What grows: size and number of blades, flowers, trees and stones.
    #[serde(default)]
    pub plants: Plants,
    /// Layers that stand for grass where it is drawn as shells (003).
    #[serde(default)]
    pub shells: Shells,
    /// Kinds of grass beside that of `[grass]` and `[plants]`, each a section `[[species]]`; with any, every ID of the covering map is that of a
    /// species, of a kind of underbrush, or 0, 253, 254 or 255. Default none, allowed at most 16.
    #[serde(default)]
    pub species: Vec<Species>,
    /// TOML file beside the scene file that holds nothing but sections `[[underbrush]]`, for scenes to share; they count as if they stood in the
    /// scene file before its own. Default empty, no such file.
    #[serde(default)]
    pub underbrush_file: String,
    /// Species of underbrush, which grows between the grass (004), each a section `[[underbrush]]`. Default none, allowed at most 16, those of
    /// `underbrush_file` among them.
    #[serde(default)]
    pub underbrush: Vec<Underbrush>,
    /// What the underbrush grows on.
    #[serde(default)]
    pub growth: Growth,
    /// Cars, monsters, helicopters, sleds and balls: how many, their models, and how they meet the grass.
    #[serde(default)]
    pub objects: Objects,
    /// Winds that press the grass as objects do, such as cyclones (001 §5.3), each a section
    /// `[[drawn_winds]]`. Default none, allowed at most 16.
    #[serde(default)]
    pub drawn_winds: Vec<DrawnWind>,
    /// Where a visitor's camera starts.
    #[serde(default)]
    pub camera: CameraStart,
    /// Sun, sky, haze and mist.
    #[serde(default)]
    pub light: Light,
    /// Lamps that stand on the land, each a section `[[lights]]`. Default none, allowed at most 8.
    #[serde(default)]
    pub lights: Vec<Lamp>,
}

fn default_seed() -> u64 {
    1
}

fn default_tick_hz() -> f32 {
    60.0
}

impl Scene {
    /// A scene of `terrain` with the defaults of all else and nothing in its summary.
    pub fn new(terrain: TerrainMaps) -> Self {
        Self {
            summary: String::new(),
            seed: default_seed(),
            tick_hz: default_tick_hz(),
            patches: Patches::default(),
            terrain,
            wind: Wind::default(),
            natural_wind: NaturalWind::default(),
            rain: Rain::default(),
            bend: BendField::default(),
            grass: Grass::default(),
            plants: Plants::default(),
            shells: Shells::default(),
            species: Vec::new(),
            underbrush_file: String::new(),
            underbrush: Vec::new(),
            growth: Growth::default(),
            objects: Objects::default(),
            drawn_winds: Vec::new(),
            camera: CameraStart::default(),
            light: Light::default(),
            lights: Vec::new(),
        }
    }

    /// Duration of one fixed step (s).
    pub fn dt_secs(&self) -> f32 {
        1.0 / self.tick_hz
    }

    /// Extent of the world along X and Z (m).
    pub fn extent_m(&self) -> [f32; 2] {
        self.patches.extent_m()
    }
}
