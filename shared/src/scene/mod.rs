//! Scenes: the contents of a scene file (TOML), each field with its meaning, unit, default and range.
//!
//! A scene file contains only fields that differ from their defaults; the shortest one names its maps. Parsing checks every field and every
//! combination; the world is made from a checked [`Scene`] alone.

mod accuracy;
mod allowed;
mod bend;
mod blade_step;
mod checks;
mod cover_model;
mod drawn_wind;
mod fault;
mod flat;
mod grass;
mod growth;
mod kinds;
mod lamp;
mod natural_wind;
mod objects;
mod parse;
mod patches;
mod picture;
mod plants;
mod positions;
mod race;
mod rain;
mod shells;
mod snow;
mod species;
mod stated;
mod stream;
mod template;
mod terrain;
mod underbrush;
mod walk;
mod wind;

pub use accuracy::{Accuracy, Budget, Tolerances};
pub use allowed::{Allowed, FIELDS, REQUIRED};
pub use bend::{BendField, ObjectContact};
pub use blade_step::{BLADE_STEPS_LIMIT, GROWTH_BY_COVER, GROWTH_BY_MEADOW, GROWTH_BY_SOIL, GROWTH_BY_TUFT};
pub use checks::limits::{AWAKE_CELLS_LIMIT, COMPONENTS_LIMIT, EXTENT_LIMIT_M, PARTS_LIMIT, SITES_LIMIT, SPECIES_LIMIT, WIND_CELLS_LIMIT};
pub use cover_model::{CoverModel, MODEL_SIDE_M, MODELS_LIMIT};
pub use drawn_wind::{DrawnWind, WindShape};
pub use fault::SceneFault;
pub use grass::Grass;
pub use growth::Growth;
pub use lamp::{LAMPS_LIMIT, Lamp};
pub use natural_wind::NaturalWind;
pub use objects::*;
pub use parse::{parse, parse_underbrush, parse_with};
pub use patches::Patches;
pub use picture::{CameraStart, Light};
pub use plants::{BladeIntegrator, BladeShape, FlowerShape, LagWay, PlantCover, Plants, TreeShape};
pub use positions::Positions;
pub use race::{AMBER_SECS, GATES_LIMIT, GREEN_SECS, Race, RaceGate};
pub use rain::Rain;
pub use shells::{ShellExtrusion, Shells};
pub use snow::Snow;
pub use species::Species;
pub use stated::stated_fields;
pub use stream::Stream;
pub use terrain::TerrainMaps;
pub use underbrush::{Component, ComponentKind, Underbrush};
pub(crate) use wind::words;
pub use wind::{
    Primitive, PrimitiveIntensity, PrimitiveKind, Wind, WindAdvection, WindBoundary, WindDiffusion, WindDust, WindFaces, WindMethod,
    WindPressure, WindTerrain, WindTiling, WindTime,
};

use serde::{Deserialize, Serialize};

/// JSON Schema (draft 2020-12) of a scene file, for completion and checks in editors: types, ranges, words, defaults and descriptions with units. It is
/// generated from [`FIELDS`], [`REQUIRED`], the defaults and the doc comments of the fields. Conflicts between values are found by [`parse`] alone.
pub const SCHEMA: &str = include_str!("../../scene.schema.json");

/// A whole scene, as a scene file describes it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// One-line description of the scene; `prairie scenes` prints it. Required.
    pub summary: String,
    /// Seed of all random numbers in the scene: placement of plants, sources of the wind. Default 1, allowed 0..=9223372036854775807.
    #[serde(default = "default_seed")]
    pub seed: u64,
    /// Simulation rate: fixed steps of the world per second (Hz). Default 60, allowed 10..=240.
    #[serde(default = "default_tick_hz")]
    pub tick_hz: f32,
    /// Extent of the world, in patches of cells of the bend field.
    #[serde(default)]
    pub patches: Patches,
    /// Height map and covering map with their scales.
    pub terrain: TerrainMaps,
    /// The wind: its box, its forcing and its solver.
    #[serde(default)]
    pub wind: Wind,
    /// Gusts of noise that push the grass near cameras (Chen & Johan §5.3).
    #[serde(default)]
    pub natural_wind: NaturalWind,
    /// Rain on the plants.
    #[serde(default)]
    pub rain: Rain,
    /// Snow on the land.
    #[serde(default)]
    pub snow: Snow,
    /// Numerical method of the bend field.
    #[serde(default)]
    pub bend: BendField,
    /// Bending and recovery of the grass: constants of the bend field.
    #[serde(default)]
    pub grass: Grass,
    /// Size and number of blades, flowers, trees and stones.
    #[serde(default)]
    pub plants: Plants,
    /// Shell rendering: layers that replace blades of grass (Bakay).
    #[serde(default)]
    pub shells: Shells,
    /// Species of grass besides that of `[grass]` and `[plants]`, each a section `[[species]]`. With any, every ID of the covering map must be that
    /// of a species, of a species of underbrush, of a model, or 0, 253, 254 or 255. Default none, allowed at most 16.
    #[serde(default)]
    pub species: Vec<Species>,
    /// TOML file beside the scene file that contains only sections `[[underbrush]]`, for several scenes to share; they count as if they came before
    /// the scene file's own. Default empty, no such file.
    #[serde(default)]
    pub underbrush_file: String,
    /// Species of underbrush, which grows between the grass (Endo et al. 2003), each a section `[[underbrush]]`. Default none, allowed at most 16,
    /// including those of `underbrush_file`.
    #[serde(default)]
    pub underbrush: Vec<Underbrush>,
    /// Soil and sites of the underbrush.
    #[serde(default)]
    pub growth: Growth,
    /// Models that the covering map places, each a section `[[models]]`. With any, every ID of the covering map must be known, as with `species`.
    /// Default none, allowed at most 8.
    #[serde(default)]
    pub models: Vec<CoverModel>,
    /// Cars, monsters, helicopters, sleds, balls and walkers: number, models, and contact with the grass.
    #[serde(default)]
    pub objects: Objects,
    /// Winds that press the grass as objects do, such as cyclones (Chen & Johan §5.3), each a section `[[drawn_winds]]`. Default none, allowed at
    /// most 16.
    #[serde(default)]
    pub drawn_winds: Vec<DrawnWind>,
    /// A race over the land: gates, laps and start light.
    #[serde(default)]
    pub race: Race,
    /// Start position of the camera.
    #[serde(default)]
    pub camera: CameraStart,
    /// Sun, sky, haze and mist.
    #[serde(default)]
    pub light: Light,
    /// Lamps on the land, each a section `[[lights]]`. Default none, allowed at most 8.
    #[serde(default)]
    pub lights: Vec<Lamp>,
    /// Largest errors of the streamed fields.
    #[serde(default)]
    pub stream: Stream,
    /// Largest errors, from which the server plans the settings that the file does not state; empty once they are planned.
    #[serde(default)]
    pub accuracy: Accuracy,
    /// Largest costs of the planned settings; empty once they are planned.
    #[serde(default)]
    pub budget: Budget,
}

fn default_seed() -> u64 {
    1
}

fn default_tick_hz() -> f32 {
    60.0
}

impl Scene {
    /// A scene of `terrain` with an empty summary and the defaults of all else.
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
            snow: Snow::default(),
            bend: BendField::default(),
            grass: Grass::default(),
            plants: Plants::default(),
            shells: Shells::default(),
            species: Vec::new(),
            underbrush_file: String::new(),
            underbrush: Vec::new(),
            growth: Growth::default(),
            models: Vec::new(),
            objects: Objects::default(),
            drawn_winds: Vec::new(),
            race: Race::default(),
            camera: CameraStart::default(),
            light: Light::default(),
            lights: Vec::new(),
            stream: Stream::default(),
            accuracy: Accuracy::default(),
            budget: Budget::default(),
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
