//! A scene with all that belongs to it.

use super::explanation::Explanation;
use crate::world::Maps;
use prairie_core::grass::wind_drawing::WindDrawings;
use prairie_core::plant::growth::NutrientMap;
use prairie_core::scene::Scene;
use prairie_core::terrain::{CoverMap, HeightMap};
use prairie_core::wire::{Mesh, ModelUse};
use std::path::PathBuf;
use std::sync::Arc;

/// A checked scene with its maps and models.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedScene {
    /// Name in links: that of a built-in scene, or of the scene file without folder and extension.
    pub name: String,
    /// The scene without paths, as sent to clients.
    pub scene: Scene,
    /// Height map (PNG file).
    pub height_png: Vec<u8>,
    /// Covering map (PNG file).
    pub covering_png: Vec<u8>,
    /// Nutrient map (PNG file); empty if the nutrients are generated.
    pub nutrient_png: Vec<u8>,
    /// Decoded height map.
    pub height: HeightMap,
    /// Decoded covering map, cleared under the models.
    pub cover: CoverMap,
    /// Decoded nutrient map; `None` if the nutrients are generated.
    pub nutrients: Option<Arc<NutrientMap>>,
    /// Pictures of the drawn winds, by the numbers that replace their file names in the scene.
    pub drawings: WindDrawings,
    /// Models of vehicles from glTF files, where other kinds use the built-in model, and those of the covering map.
    pub models: Vec<(ModelUse, Mesh)>,
    /// Files that were read, the scene file first; empty for a built-in scene.
    pub files: Vec<PathBuf>,
    /// What the scene models, by which methods, and what is planned.
    pub explanation: Arc<Explanation>,
}

impl LoadedScene {
    /// The maps from which the world is built.
    pub fn maps(&self) -> Maps {
        Maps { height: self.height.clone(), cover: self.cover.clone(), drawings: self.drawings.clone(), nutrients: self.nutrients.clone() }
    }
}

/// A loaded scene as its file has it, and the fields that the file states.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenScene {
    /// The scene, with its tolerances and budgets.
    pub loaded: LoadedScene,
    /// Paths of the stated fields.
    pub stated: Vec<String>,
}

impl OpenScene {
    /// The stated fields of sections.
    pub(crate) fn stated_in(&self, sections: &[&str]) -> Vec<String> {
        let is_in = |path: &&String| sections.iter().any(|section| path.starts_with(&format!("{section}.")));
        self.stated.iter().filter(is_in).cloned().collect()
    }
}
