//! The JSON Schema of scene files: generated from the table, the defaults and the doc comments, and as strict as the parser about single values.

use super::documented::{Field, list, with_sections};
use super::{complete, value_at, with_number};
use boon::{Compiler, SchemaIndex, Schemas};
use prairie_core::scene::{Allowed, FIELDS, REQUIRED, SCHEMA, parse};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};

/// A number without a fraction as an integer, and a single-precision one as it is written.
fn number(value: f64) -> Value {
    let written = || (value as f32).to_string().parse::<f64>().unwrap();
    if value.fract() == 0.0 { json!(value as i64) } else { json!(written()) }
}

fn to_json(value: &toml::Value) -> Value {
    match value {
        toml::Value::Float(value) => number(*value),
        toml::Value::Array(items) => items.iter().map(to_json).collect(),
        other => serde_json::to_value(other).unwrap(),
    }
}

/// Schema of a value that is neither a list nor a section.
fn single(value: &toml::Value, allowed: Allowed) -> Value {
    match allowed {
        Allowed::Range(low, high) | Allowed::Places(.., low, high) => {
            let kind = if value.is_integer() { "integer" } else { "number" };
            json!({ "type": kind, "minimum": number(low), "maximum": number(high) })
        }
        Allowed::OneOf(words) => json!({ "enum": words }),
        Allowed::Name => json!({ "type": "string", "pattern": "\\S" }),
        Allowed::Text | Allowed::Sections(..) | Allowed::Course(..) => json!({ "type": "string" }),
    }
}

fn array(least: usize, most: usize, items: Value) -> Value {
    json!({ "type": "array", "minItems": least, "maxItems": most, "items": items })
}

/// Schema of a section with the fields of `values`.
fn section(values: &toml::Table, path: &str) -> Value {
    let inner = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    let properties: Map<_, _> = values.iter().map(|(key, value)| (key.clone(), described(value, &inner(key)))).collect();
    let required: Vec<_> = values.keys().filter(|key| REQUIRED.contains(&inner(key).as_str())).collect();
    let mut schema = json!({ "type": "object", "properties": properties, "additionalProperties": false });
    if !required.is_empty() {
        schema["required"] = json!(required);
    }
    schema
}

/// Schema of the field or section at `path`, with its description and its default.
fn described(value: &toml::Value, path: &str) -> Value {
    let allowed = Allowed::at(path);
    let mut schema = match (value, allowed) {
        (toml::Value::Table(values), _) => section(values, path),
        (toml::Value::Array(items), Allowed::Sections(least, most)) => array(least, most, section(items[0].as_table().unwrap(), path)),
        (toml::Value::Array(points), Allowed::Places(least, most, ..)) => {
            array(least, most, array(2, 2, single(&points[0].as_array().unwrap()[0], allowed)))
        }
        (toml::Value::Array(_), Allowed::Course(least, most, secs, intensity)) => {
            let coordinates = [secs, intensity].map(|[low, high]| single(&toml::Value::Float(low), Allowed::Range(low, high)));
            let point = json!({ "type": "array", "minItems": 2, "maxItems": 2, "prefixItems": coordinates });
            array(least, most, point)
        }
        (toml::Value::Array(items), _) => array(items.len(), items.len(), single(&items[0], allowed)),
        _ => single(value, allowed),
    };
    let Field { doc, .. } = with_sections().into_iter().find(|field| field.path == path).unwrap();
    let words = match allowed {
        Allowed::OneOf(words) => list(words, &mut Vec::new()),
        _ => None,
    };
    schema["description"] = json!(doc.clone() + &words.unwrap_or_default());
    let is_open = REQUIRED.contains(&path) || value.is_table() || matches!(allowed, Allowed::Sections(..)) || doc.contains("or as in");
    if !is_open {
        schema["default"] = to_json(value);
    }
    schema
}

fn generated() -> Value {
    let mut schema = section(&complete(), "");
    schema["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    schema["title"] = json!("Prairie scene");
    schema["description"] = json!("A scene of Prairie. Units are metres, seconds and radians; X points east, Z points south.");
    schema.sort_all_objects();
    schema
}

type Compiled = (Schemas, SchemaIndex);

/// The stored schema, ready to validate. Its own validity is checked too.
fn compiled() -> Compiled {
    let (mut schemas, mut compiler) = (Schemas::new(), Compiler::new());
    compiler.add_resource("scene.schema.json", serde_json::from_str(SCHEMA).unwrap()).unwrap();
    let index = compiler.compile("scene.schema.json", &mut schemas).unwrap();
    (schemas, index)
}

fn validate(text: &str, (schemas, index): &Compiled) -> Result<(), String> {
    let scene: toml::Table = text.parse().map_err(|error: toml::de::Error| error.to_string())?;
    schemas.validate(&serde_json::to_value(scene).unwrap(), *index).map_err(|error| error.to_string())
}

/// TOML files in a folder of the workspace.
fn files(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder);
    let paths = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = paths.filter(|path| path.extension().is_some_and(|end| end == "toml")).collect();
    files.sort();
    files
}

/// Broken scenes whose faults are all conflicts between fields or faults of other files, which a schema cannot see.
const CONFLICTS: [&str; 31] = [
    "accuracy",
    "drawn-winds-too-hard",
    "drawn-winds",
    "endless-model",
    "models-crowd",
    "models-hole",
    "models-twice",
    "models-unreadable",
    "no-nutrients",
    "no-underbrush-file",
    "no-world",
    "race-one-gate",
    "sled-of-no-area",
    "sled-outline",
    "snow",
    "species-hole",
    "underbrush-file",
    "underbrush-hole",
    "underbrush-misfits",
    "underbrush-twice",
    "unreadable-model",
    "wind-endless",
    "wind-faces",
    "wind-follow",
    "wind-obstacle",
    "wind-patch",
    "wind-reflection",
    "wind-stable-fluids",
    "wind-through-faces",
    "wind-time",
    "wrong-maps",
];

#[test]
fn the_stored_schema_is_the_generated_one() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scene.schema.json");
    if std::env::var_os("PRAIRIE_UPDATE").is_some() {
        std::fs::write(&path, format!("{:#}\n", generated())).unwrap();
    }
    let stored: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    assert!(stored == generated(), "scene.schema.json is old; run again with PRAIRIE_UPDATE=1");
}

#[test]
fn every_valid_scene_validates() {
    let (schema, mut count) = (compiled(), 0);
    for path in ["server/scenes", "server/scenes/starter", "tests/scenes", "tests/scenes/species"].into_iter().flat_map(files) {
        let text = std::fs::read_to_string(&path).unwrap();
        // All others are files of species only.
        if text.contains("\n[terrain]\n") {
            validate(&text, &schema).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            count += 1;
        }
    }
    assert!(count >= 13, "only {count} scenes were found");
    validate(&complete().to_string(), &schema).unwrap();
}

#[test]
fn broken_scenes_do_not_validate_unless_their_fields_conflict() {
    let (schema, broken) = (compiled(), files("tests/scenes/broken"));
    assert!(broken.len() > 30);
    let name = |path: &Path| path.file_stem().unwrap().to_str().unwrap().to_owned();
    let is_valid = |path: &PathBuf| validate(&std::fs::read_to_string(path).unwrap(), &schema).is_ok();
    let passed: Vec<_> = broken.into_iter().filter(is_valid).map(|path| name(&path)).collect();
    assert_eq!(passed, CONFLICTS);
}

#[test]
fn the_schema_rejects_single_values_where_the_parser_does() {
    let (schemas, index) = compiled();
    let assert_same = |scene: &toml::Table, what: &str| {
        let valid = schemas.validate(&serde_json::to_value(scene).unwrap(), index).is_ok();
        // Faults of single values name what is allowed or expected there; a schema knows nothing of the others.
        let faults = parse(&scene.to_string()).err().unwrap_or_default();
        let path = what.split(' ').next().unwrap();
        let allowed = match Allowed::at(path) {
            Allowed::Places(.., low, high) => vec![Allowed::Range(low, high)],
            Allowed::Course(.., [first, last], [low, high]) => vec![Allowed::Range(first, last), Allowed::Range(low, high)],
            other => vec![other],
        };
        let is_single = |message: &str| {
            allowed.iter().any(|allowed| message.ends_with(&format!("allowed: {allowed}")))
                || ["; expected ", " sections; ", " points; "].iter().any(|part| message.contains(part))
        };
        let rejected = faults.iter().any(|fault| is_single(&fault.message));
        assert_eq!(valid, !rejected, "{what}: {faults:?}");
    };
    for (path, allowed) in FIELDS {
        let values: Vec<toml::Value> = match allowed {
            Allowed::Range(low, high) | Allowed::Places(.., low, high) => {
                let is_whole = |value: &toml::Value| value.is_integer() || value.as_array().is_some_and(|items| items[0].is_integer());
                if is_whole(value_at(&mut complete(), path)) {
                    let [low, high] = [low as i64, high as i64];
                    [low, high, low - 1, high.saturating_add(1).max(high)].map(toml::Value::Integer).into()
                } else {
                    [low, high, low - 0.01, high + 0.01, f64::NAN].map(toml::Value::Float).into()
                }
            }
            Allowed::OneOf(words) => words.iter().copied().chain(["wel", ""]).map(toml::Value::from).collect(),
            Allowed::Name => ["a", " ", ""].map(toml::Value::from).into(),
            Allowed::Course(_, most, [first, last], [low, high]) => {
                let points =
                    [[first, low], [last, high], [first - 0.01, low], [last + 0.01, low], [first, low - 0.01], [first, high + 0.01]];
                let pairs = points.into_iter().chain([[f64::NAN, low], [first, f64::NAN]]).map(|point| vec![point.to_vec(); 2]);
                let others = [vec![vec![first]; 2], vec![vec![first; 3]; 2], vec![vec![first; 2]; most], vec![vec![first; 2]; most + 1]];
                pairs.chain(others).map(toml::Value::from).collect()
            }
            Allowed::Text | Allowed::Sections(..) => vec![],
        };
        for value in values.into_iter().chain([true.into()]) {
            let mut scene = complete();
            let place = value_at(&mut scene, path);
            *place = if value.is_integer() || value.is_float() { with_number(place, &value) } else { value.clone() };
            assert_same(&scene, &format!("{path} = {value}"));
        }
        let mut scene = complete();
        if let toml::Value::Array(items) = value_at(&mut scene, path) {
            let longer = items.iter().cycle().take(items.len() + 100).cloned().collect();
            *items = longer;
            assert_same(&scene, &format!("{path} longer"));
        }
    }
}
