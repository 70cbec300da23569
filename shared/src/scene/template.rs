//! What a file's values are put in the place of: all fields with their defaults, so that their names and kinds need no second list.

use super::walk::Walk;
use super::{
    Component, ComponentKind, DrawnWind, Grass, Lamp, Plants, Primitive, PrimitiveKind, Scene, Species, TerrainMaps, Underbrush, Wind,
    WindMethod, WindShape,
};
use serde::{Deserialize, Serialize};
use toml::de::DeTable;
use toml::{Table, Value};

/// A scene with all its fields; what the file at `root` leaves unsaid of the wind follows from its method.
pub(super) fn scene(root: &DeTable<'_>) -> Table {
    let terrain = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [1.0; 2], level_m: 0.1, base_m: 0.0 };
    table(Scene { wind: Wind::of(wind_method(root)), ..Scene::new(terrain) })
}

/// The wind's method that a file names.
fn wind_method(root: &DeTable<'_>) -> WindMethod {
    let wind = root.get("wind").and_then(|wind| wind.get_ref().as_table());
    let word = wind.and_then(|wind| wind.get("method")).and_then(|method| method.get_ref().as_str());
    word.and_then(|word| Value::from(word).try_into().ok()).unwrap_or(WindMethod::Staggered)
}

/// One section of the list of sections `field`, with all its fields; of `[[species]]` see [`species`].
pub(super) fn section(field: &str) -> Table {
    match field {
        "wind.primitives" => table(Primitive::new(PrimitiveKind::Uniform, [0.0; 3])),
        "underbrush" => table(Underbrush::new("", Vec::new())),
        "underbrush.components" => table(Component::new("", ComponentKind::Leaf)),
        "drawn_winds" => table(DrawnWind::new(WindShape::Outward, vec![[0.0; 2]])),
        "lights" => table(Lamp::new([0.0; 3])),
        _ => Table::new(),
    }
}

/// One section `[[species]]` with all its fields: what it leaves unsaid is as in a file's own `[grass]` and `[plants]`.
pub(super) fn species(text: &str, scene: &Table, root: &DeTable<'_>) -> Table {
    // Faults in those two sections are told when the file itself is walked through.
    let mut walk = Walk::new(text, "a scene", scene);
    let mut section = |name: &str| {
        let mut section = scene[name].clone();
        if let Some(found) = root.get(name) {
            walk.value(&mut section, found.get_ref(), found.span(), name);
        }
        section
    };
    let grass = Grass::deserialize(section("grass")).unwrap_or_default();
    let plants = Plants::deserialize(section("plants")).unwrap_or_default();
    table(Species::new("", 1, &grass, &plants))
}

fn table(fields: impl Serialize) -> Table {
    Table::try_from(fields).unwrap_or_default()
}
