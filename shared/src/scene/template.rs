//! Defaults of all fields, overwritten by a file's values, so that no second list of names and types is needed.

use super::flat::{flatten, flatten_species, nest_grass};
use super::walk::Walk;
use super::{
    Component, ComponentKind, CoverModel, DrawnWind, Grass, Lamp, Plants, Primitive, PrimitiveKind, RaceGate, Scene, Species, TerrainMaps,
    Underbrush, Wind, WindMethod, WindShape,
};
use serde::{Deserialize, Serialize};
use toml::de::DeTable;
use toml::{Table, Value};

/// A scene with all its fields; the defaults of the wind follow from the method that the file at `root` names.
pub(super) fn scene(root: &DeTable<'_>) -> Table {
    let terrain = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [1.0; 2], level_m: 0.1, base_m: 0.0 };
    let mut scene = table(Scene { wind: Wind::of(wind_method(root)), ..Scene::new(terrain) });
    flatten(&mut scene);
    scene
}

/// The wind's method that a file names.
fn wind_method(root: &DeTable<'_>) -> WindMethod {
    let wind = root.get("wind").and_then(|wind| wind.get_ref().as_table());
    let word = wind.and_then(|wind| wind.get("method")).and_then(|method| method.get_ref().as_str());
    word.and_then(|word| Value::from(word).try_into().ok()).unwrap_or(WindMethod::Staggered)
}

/// One section of the list of sections `field`, with all its fields; for `[[species]]` see [`species`].
pub(super) fn section(field: &str) -> Table {
    match field {
        "wind.primitives" => table(Primitive::new(PrimitiveKind::Uniform, [0.0; 3])),
        "underbrush" => table(Underbrush::new("", Vec::new())),
        "underbrush.components" => table(Component::new("", ComponentKind::Leaf)),
        "models" => table(CoverModel::new("", 1, "")),
        "drawn_winds" => table(DrawnWind::new(WindShape::Outward, vec![[0.0; 2]])),
        "race.gates" => table(RaceGate::new([0.0; 2], 0.0)),
        "lights" => table(Lamp::new([0.0; 3])),
        _ => Table::new(),
    }
}

/// One section `[[species]]` with all its fields; its defaults are the file's own `[grass]` and `[plants]`.
pub(super) fn species(text: &str, scene: &Table, root: &DeTable<'_>) -> Table {
    // Faults in those two sections are reported by the walk through the file itself.
    let mut walk = Walk::new(text, "a scene", scene);
    let mut section = |name: &str| {
        let mut section = scene[name].clone();
        if let Some(found) = root.get(name) {
            walk.value(&mut section, found.get_ref(), found.span(), name);
        }
        section
    };
    let mut grass = section("grass");
    grass.as_table_mut().into_iter().for_each(nest_grass);
    let grass = Grass::deserialize(grass).unwrap_or_default();
    let plants = Plants::deserialize(section("plants")).unwrap_or_default();
    let mut species = table(Species::new("", 1, &grass, &plants));
    flatten_species(&mut species);
    species
}

fn table(fields: impl Serialize) -> Table {
    Table::try_from(fields).unwrap_or_default()
}
