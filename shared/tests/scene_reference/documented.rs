//! The fields of a scene file with their doc comments, read from the sources.

use prairie_core::scene::{VehicleKind, WindAdvection, WindBoundary};
use std::fmt::Write;
use std::path::Path;

/// A documented field of a scene file.
pub(crate) struct Field {
    pub(crate) path: String,
    pub(crate) doc: String,
}

/// Source files and, for each struct in them, the section that it documents.
const SOURCES: [(&str, &[(&str, &str)]); 25] = [
    ("mod.rs", &[("Scene", "")]),
    ("patches.rs", &[("Patches", "patches")]),
    ("terrain.rs", &[("TerrainMaps", "terrain")]),
    ("wind/mod.rs", &[("Wind", "wind")]),
    ("wind/faces.rs", &[("WindFaces", "wind.faces")]),
    ("wind/dust.rs", &[("WindDust", "wind.dust")]),
    ("wind/primitive.rs", &[("Primitive", "wind.primitives")]),
    ("natural_wind.rs", &[("NaturalWind", "natural_wind")]),
    ("rain.rs", &[("Rain", "rain")]),
    ("snow.rs", &[("Snow", "snow")]),
    ("bend.rs", &[("BendField", "bend")]),
    ("grass.rs", &[("Grass", "grass")]),
    ("plants.rs", &[("Plants", "plants")]),
    ("shells.rs", &[("Shells", "shells")]),
    ("species.rs", &[("Species", "species")]),
    ("underbrush.rs", &[("Underbrush", "underbrush"), ("Component", "underbrush.components")]),
    ("growth.rs", &[("Growth", "growth")]),
    ("cover_model.rs", &[("CoverModel", "models")]),
    ("objects.rs", &[("Objects", "objects")]),
    ("drawn_wind.rs", &[("DrawnWind", "drawn_winds")]),
    ("race.rs", &[("Race", "race"), ("RaceGate", "race.gates")]),
    ("picture.rs", &[("CameraStart", "camera"), ("Light", "light")]),
    ("lamp.rs", &[("Lamp", "lights")]),
    ("stream.rs", &[("Stream", "stream")]),
    ("accuracy.rs", &[("Accuracy", "accuracy"), ("Budget", "budget")]),
];

/// Sections that may occur once, without those of [`tread_sections`].
const SECTIONS: [&str; 20] = [
    "patches",
    "terrain",
    "wind",
    "wind.faces",
    "wind.dust",
    "natural_wind",
    "rain",
    "snow",
    "bend",
    "grass",
    "plants",
    "shells",
    "growth",
    "objects",
    "race",
    "camera",
    "light",
    "stream",
    "accuracy",
    "budget",
];

/// Structs whose fields a file writes directly in the section around them: field, file and name.
const FLAT: [(&str, &str, &str); 2] = [("waves", "../bend/params.rs", "WaveParams"), ("grass", "grass.rs", "Grass")];

/// The struct of each kind of vehicle's contact with the grass, and its section.
fn tread_sections() -> impl Iterator<Item = (String, String)> {
    VehicleKind::ALL.into_iter().map(|kind| (format!("{kind:?}Tread"), format!("objects.{}", kind.name())))
}

/// Sections that may occur once.
pub(crate) fn sections() -> impl Iterator<Item = String> {
    SECTIONS.into_iter().map(str::to_owned).chain(tread_sections().map(|(_, section)| section))
}

/// The documented fields of one struct, by their own names, in order.
fn fields_of(file: &str, name: &str, section: &str) -> Vec<Field> {
    let source = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/scene").join(file)).unwrap();
    let start = source.find(&format!("pub struct {name} {{")).unwrap();
    let body = &source[start..start + source[start..].find("\n}").unwrap()];
    let (mut fields, mut doc) = (Vec::new(), Vec::new());
    for line in body.lines().map(str::trim) {
        if let Some(text) = line.strip_prefix("///") {
            doc.push(text.trim());
        } else if let Some((key, _)) = line.strip_prefix("pub ").and_then(|line| line.split_once(": ")) {
            let doc = std::mem::take(&mut doc).join(" ");
            match FLAT.iter().find(|(part, ..)| *part == key && !section.is_empty()) {
                Some((_, file, name)) => fields.extend(fields_of(file, name, section)),
                None => fields.push(Field { path: key.to_owned(), doc }),
            }
        }
    }
    fields
}

/// Documentation of a field of `[grass]` as it reads in `[[species]]`.
fn as_in_grass(doc: &str) -> String {
    let (meaning, rest) = doc.split_once("Default ").unwrap();
    let end = rest.find([' ', ',', ';']).unwrap();
    format!("{meaning}Default {} or as in `[grass]`{}", &rest[..end], &rest[end..])
}

/// Every field, without the sections that may occur once.
pub(crate) fn documented() -> Vec<Field> {
    let mut fields = with_sections();
    fields.retain(|field| !sections().any(|section| section == field.path));
    fields
}

/// Every field and section.
pub(crate) fn with_sections() -> Vec<Field> {
    let mut fields = Vec::new();
    for (file, structs) in SOURCES {
        for (name, section) in structs {
            let mut found = fields_of(file, name, section);
            if *section == "species" {
                found.retain(|field| field.path != "laid_recovery_secs");
                found.iter_mut().filter(|field| field.doc.contains("Default") && !field.doc.contains("as in")).for_each(|field| {
                    field.doc = as_in_grass(&field.doc);
                });
            }
            if !section.is_empty() {
                found.iter_mut().for_each(|field| field.path = format!("{section}.{}", field.path));
            }
            fields.extend(found);
            if *section == "objects" {
                for (name, section) in tread_sections() {
                    let tread = fields_of(file, &name, &section);
                    fields.extend(tread.into_iter().map(|Field { path, doc }| Field { path: format!("{section}.{path}"), doc }));
                }
            }
        }
    }
    fields
}

/// Words that the README explains by the doc comments of their enum, with its source file and name. Doc comments of fields need not list them.
pub(crate) const EXPLAINED: [(&[&str], &str, &str); 2] =
    [(WindAdvection::WORDS, "wind/words.rs", "WindAdvection"), (WindBoundary::WORDS, "wind/faces.rs", "WindBoundary")];

/// The README's description of a field's words: their meanings at the first field that takes them, then the words alone.
pub(crate) fn list(words: &'static [&'static str], explained: &mut Vec<&'static [&'static str]>) -> Option<String> {
    let (_, file, name) = EXPLAINED.into_iter().find(|(known, ..)| *known == words)?;
    if explained.contains(&words) {
        return Some(format!(" One of {}.", words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", ")));
    }
    explained.push(words);
    let source = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/scene").join(file)).unwrap();
    let start = source.find(&format!("    {name} {{\n")).unwrap();
    let (mut text, mut doc) = (" One of".to_owned(), Vec::new());
    for line in source[start..].lines().skip(1).map(str::trim).take_while(|line| *line != "}") {
        if let Some(part) = line.strip_prefix("///") {
            doc.push(part.trim());
        } else if let Some((_, word)) = line.trim_end_matches(',').split_once(" = ") {
            let meaning = std::mem::take(&mut doc).join(" ");
            write!(text, "{} `{}`: {}", if text.ends_with("of") { "" } else { ";" }, word.trim_matches('"'), meaning.trim_end_matches('.'))
                .unwrap();
        }
    }
    Some(text + ".")
}
