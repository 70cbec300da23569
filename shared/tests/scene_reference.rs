//! The doc comments of the scene's structs, the table of allowed values, the defaults and the README say the same.

use shared::scene::{Allowed, FIELDS, REQUIRED, parse};
use std::fmt::Write;
use std::path::Path;

/// A documented field of a scene file.
struct Field {
    path: String,
    doc: String,
}

/// Source files and, for each struct in them, the section that it describes.
const SOURCES: [(&str, &[(&str, &str)]); 20] = [
    ("mod.rs", &[("Scene", "")]),
    ("patches.rs", &[("Patches", "patches")]),
    ("terrain.rs", &[("TerrainMaps", "terrain")]),
    ("wind/mod.rs", &[("Wind", "wind")]),
    ("wind/faces.rs", &[("WindFaces", "wind.faces")]),
    ("wind/dust.rs", &[("WindDust", "wind.dust")]),
    ("wind/primitive.rs", &[("Primitive", "wind.primitives")]),
    ("natural_wind.rs", &[("NaturalWind", "natural_wind")]),
    ("rain.rs", &[("Rain", "rain")]),
    ("bend.rs", &[("BendField", "bend")]),
    ("grass.rs", &[("Grass", "grass")]),
    ("plants.rs", &[("Plants", "plants")]),
    ("shells.rs", &[("Shells", "shells")]),
    ("species.rs", &[("Species", "species")]),
    ("underbrush.rs", &[("Underbrush", "underbrush"), ("Component", "underbrush.components")]),
    ("growth.rs", &[("Growth", "growth")]),
    (
        "objects.rs",
        &[
            ("Objects", "objects"),
            ("CarTread", "objects.car"),
            ("MonsterTread", "objects.monster"),
            ("HelicopterTread", "objects.helicopter"),
            ("SledTread", "objects.sled"),
            ("BallTread", "objects.ball"),
        ],
    ),
    ("drawn_wind.rs", &[("DrawnWind", "drawn_winds")]),
    ("picture.rs", &[("CameraStart", "camera"), ("Light", "light")]),
    ("lamp.rs", &[("Lamp", "lights")]),
];

/// Sections that may stand once.
const SECTIONS: [&str; 20] = [
    "patches",
    "terrain",
    "wind",
    "wind.faces",
    "wind.dust",
    "natural_wind",
    "rain",
    "bend",
    "grass",
    "plants",
    "shells",
    "growth",
    "objects",
    "objects.car",
    "objects.monster",
    "objects.helicopter",
    "objects.sled",
    "objects.ball",
    "camera",
    "light",
];

fn documented() -> Vec<Field> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/scene");
    let mut fields = Vec::new();
    for (file, structs) in SOURCES {
        let source = std::fs::read_to_string(folder.join(file)).unwrap();
        for (name, section) in structs {
            let start = source.find(&format!("pub struct {name} {{")).unwrap();
            let body = &source[start..start + source[start..].find("\n}").unwrap()];
            let mut doc = Vec::new();
            for line in body.lines().map(str::trim) {
                if let Some(text) = line.strip_prefix("///") {
                    doc.push(text.trim());
                } else if let Some((key, _)) = line.strip_prefix("pub ").and_then(|line| line.split_once(": ")) {
                    let path = if section.is_empty() { key.to_owned() } else { format!("{section}.{key}") };
                    fields.push(Field { path, doc: std::mem::take(&mut doc).join(" ") });
                }
            }
        }
    }
    fields.retain(|field| !SECTIONS.contains(&field.path.as_str()));
    fields
}

/// The numbers in `text`, in order.
fn numbers(text: &str) -> Vec<f64> {
    let text = text.replace('−', "-").replace("..=", " ");
    let words = text.split(|c: char| !(c.is_ascii_digit() || ['.', '-', 'e'].contains(&c)));
    words.filter_map(|word| word.trim_end_matches('.').parse().ok()).collect()
}

fn after<'a>(doc: &'a str, word: &str) -> Option<&'a str> {
    doc.find(word).map(|at| &doc[at + word.len()..])
}

fn minimal() -> toml::Table {
    toml::from_str(
        "summary = ''\n[terrain]\nheight_map = 'h.png'\ncovering_map = 'c.png'\npixel_m = [0.5, 0.5]\nlevel_m = 0.1\nbase_m = 0.0\n",
    )
    .unwrap()
}

/// A scene with every field written out, and one section in each list of sections.
fn complete() -> toml::Table {
    let text = minimal().to_string()
        + "[[wind.primitives]]\nkind = 'source'\nat_m = [1.0, 2.0, 3.0]\n[[species]]\nname = 'a'\ncover = 1\n"
        + "[[underbrush]]\nname = 'a'\n[[underbrush.components]]\nname = 'a'\nkind = 'leaf'\n"
        + "[[drawn_winds]]\nshape = 'swirl'\npath_m = [[1.0, 2.0]]\n[[lights]]\nat_m = [1.0, 2.0, 3.0]\n";
    toml::Table::try_from(parse(&text).unwrap()).unwrap()
}

/// The section around the field at `path`, and the field's own name.
fn section_of<'t, 'p>(table: &'t mut toml::Table, path: &'p str) -> (&'t mut toml::Table, &'p str) {
    let Some((section, key)) = path.rsplit_once('.') else { return (table, path) };
    let section = match value_at(table, section) {
        toml::Value::Array(sections) => &mut sections[0],
        section => section,
    };
    (section.as_table_mut().unwrap(), key)
}

fn value_at<'t>(table: &'t mut toml::Table, path: &str) -> &'t mut toml::Value {
    let (section, key) = section_of(table, path);
    &mut section[key]
}

/// Paths of all that is no section, those of a list of sections without places in it.
fn paths_in(table: &toml::Table, section: &str) -> Vec<String> {
    let mut paths = Vec::new();
    for (key, value) in table {
        let path = format!("{section}{key}");
        let inner = value.as_table().or_else(|| value.as_array()?.first()?.as_table());
        paths.extend(inner.into_iter().flat_map(|table| paths_in(table, &format!("{path}."))));
        if !value.is_table() {
            paths.push(path);
        }
    }
    paths
}

/// A path as the table of fields has it, without places in lists.
fn field_of(path: &str) -> String {
    path.split('[').map(|part| part.split_once(']').map_or(part, |(_, rest)| rest)).collect()
}

/// `value` with every number replaced.
fn with_number(value: &toml::Value, number: &toml::Value) -> toml::Value {
    match value {
        toml::Value::Array(items) => items.iter().map(|item| with_number(item, number)).collect::<Vec<_>>().into(),
        _ => number.clone(),
    }
}

#[test]
fn every_field_is_in_the_table_once_and_in_order() {
    let documented: Vec<_> = documented().into_iter().map(|field| field.path).collect();
    assert_eq!(documented, FIELDS.map(|(path, _)| path.to_owned()));
    let mut serialised = paths_in(&complete(), "");
    let mut fields = documented;
    serialised.sort();
    fields.sort();
    assert_eq!(serialised, fields);
}

#[test]
fn doc_comments_give_the_checked_range_and_the_true_default() {
    let mut scene = complete();
    for (field, (path, allowed)) in documented().iter().zip(FIELDS) {
        if let Allowed::Range(low, high) = allowed {
            let stated = numbers(after(&field.doc, "allowed ").unwrap_or_else(|| panic!("{path} states no range")));
            assert_eq!(stated[..2], [low, high], "{path}: {}", field.doc);
        }
        if let Allowed::Places(least, most, low, high) = allowed {
            let stated = numbers(after(&field.doc, "allowed ").unwrap());
            assert_eq!(stated[..4], [least as f64, most as f64, low, high], "{path}: {}", field.doc);
        }
        if let Allowed::Sections(least, most) = allowed {
            let stated = after(&field.doc, "allowed ").unwrap().split(',').next().unwrap();
            let expected = if least == 0 { vec![most as f64] } else { vec![least as f64, most as f64] };
            assert_eq!(numbers(stated), expected, "{path}: {}", field.doc);
        }
        if allowed == Allowed::Name {
            assert!(field.doc.contains("not empty"), "{path}: {}", field.doc);
        }
        if let Allowed::OneOf(words) = allowed {
            assert!(words.iter().all(|word| field.doc.contains(&format!("`{word}`"))), "{path}: {}", field.doc);
        }
        if REQUIRED.contains(&path) {
            assert!(field.doc.contains("Required"), "{path} does not say that it is required");
            continue;
        }
        let stated = after(&field.doc, "Default ").unwrap_or_else(|| panic!("{path} states no default"));
        let values = match value_at(&mut scene, path).clone() {
            toml::Value::Array(items) => items.into_iter().flat_map(|item| item.as_array().cloned().unwrap_or(vec![item])).collect(),
            value => vec![value],
        };
        for (i, value) in values.iter().enumerate() {
            match value {
                toml::Value::Table(_) => assert!(stated.starts_with("none"), "{path}: {}", field.doc),
                toml::Value::String(word) => assert!(stated.contains(word.as_str()), "{path}: {}", field.doc),
                _ => {
                    let value = value.as_float().unwrap_or_else(|| value.as_integer().unwrap() as f64);
                    assert!((numbers(stated)[i] - value).abs() <= 1e-6 * value.abs(), "{path} is {value}: {}", field.doc);
                }
            }
        }
    }
}

#[test]
fn every_number_is_checked() {
    for (path, allowed) in FIELDS {
        let (Allowed::Range(low, high) | Allowed::Places(.., low, high)) = allowed else { continue };
        let mut absurd =
            vec![f64::NAN.into(), f64::INFINITY.into(), f64::NEG_INFINITY.into(), (high * 2.0 + 1e6).into(), (low - 1e6).into()];
        absurd.push(toml::Value::Integer(i64::MIN));
        absurd.push(toml::Value::String("many".to_owned()));
        absurd.push(toml::Value::Boolean(true));
        for number in absurd {
            let mut scene = complete();
            let value = value_at(&mut scene, path);
            *value = with_number(value, &number);
            let faults = parse(&scene.to_string()).expect_err(&format!("{path} may be {number}"));
            assert!(faults.iter().all(|fault| field_of(&fault.path) == path), "{path} = {number}: {faults:?}");
            assert!(faults.iter().all(|fault| fault.line > 0 && fault.message.contains("allowed") || fault.message.contains("expected")));
        }
    }
}

#[test]
fn every_word_is_known_and_no_other() {
    for (path, allowed) in FIELDS {
        let Allowed::OneOf(words) = allowed else { continue };
        for word in words.iter().copied().chain(["wel", ""]) {
            let mut scene = complete();
            *value_at(&mut scene, path) = word.into();
            let faults = parse(&scene.to_string()).err().unwrap_or_default();
            let refused =
                faults.iter().any(|fault| field_of(&fault.path) == path && fault.message.ends_with(&format!("allowed: {allowed}")));
            assert_eq!(refused, !words.contains(&word), "{path} = {word:?}: {faults:?}");
        }
    }
}

#[test]
fn the_ends_of_every_range_pass_the_check_of_that_range() {
    for (path, allowed) in FIELDS {
        let Allowed::Range(low, high) = allowed else { continue };
        for end in [low, high] {
            let mut scene = complete();
            let value = value_at(&mut scene, path);
            let whole = value.is_integer() || value.as_array().is_some_and(|items| items[0].is_integer());
            let number = if whole { toml::Value::Integer(end as i64) } else { end.into() };
            *value = with_number(value, &number);
            let ranges = parse(&scene.to_string()).err().unwrap_or_default();
            let out_of_range = format!("allowed: {allowed}");
            assert!(ranges.iter().all(|fault| !fault.message.ends_with(&out_of_range)), "{path} = {end}: {ranges:?}");
        }
    }
}

#[test]
fn exactly_the_required_fields_are_required() {
    for path in FIELDS.iter().map(|(path, _)| *path).chain(SECTIONS) {
        let mut scene = complete();
        let (section, key) = section_of(&mut scene, path);
        section.remove(key);
        let missing = parse(&scene.to_string()).err().map(|faults| field_of(&faults[0].path));
        assert_eq!(missing.as_deref(), REQUIRED.contains(&path).then_some(path));
    }
}

#[test]
fn the_readme_shows_every_field() {
    let mut tables = String::new();
    let mut section = None;
    for field in documented() {
        let (name, key) = field.path.rsplit_once('.').unwrap_or(("", &field.path));
        if section.as_deref() != Some(name) {
            let is_list = FIELDS.iter().any(|(path, allowed)| *path == name && matches!(allowed, Allowed::Sections(..)));
            let title = match name {
                "" => "At the top".to_owned(),
                _ if is_list => format!("`[[{name}]]`"),
                _ => format!("`[{name}]`"),
            };
            write!(tables, "\n{title}\n\n| Field | Meaning |\n|---|---|\n").unwrap();
            section = Some(name.to_owned());
        }
        writeln!(tables, "| `{key}` | {} |", field.doc).unwrap();
    }

    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md");
    let readme = std::fs::read_to_string(&path).unwrap();
    let (head, rest) = readme.split_once("<!-- fields -->\n").unwrap();
    let (found, tail) = rest.split_once("<!-- /fields -->").unwrap();
    if std::env::var_os("PRAIRIE_UPDATE").is_some() {
        std::fs::write(&path, format!("{head}<!-- fields -->\n{tables}<!-- /fields -->{tail}")).unwrap();
    } else {
        assert!(found == tables, "the README's tables are old; run again with PRAIRIE_UPDATE=1");
    }
}
