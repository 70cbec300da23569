//! From the text of a scene file to a checked [`Scene`], or to everything that is wrong with it.

use super::allowed::{Allowed, FIELDS, REQUIRED, allowed_at};
use super::check::{Misfit, cross_checks};
use super::{DrawnWind, Grass, Plants, Primitive, PrimitiveKind, Scene, SceneFault, Species, TerrainMaps, Wind, WindMethod, WindShape};
use serde::Deserialize;
use std::ops::Range;
use toml::Value;
use toml::de::{DeArray, DeTable, DeValue};

/// Reads a scene file's text and checks every value.
///
/// # Errors
/// Every fault of the text at once, in the order of its lines: what is no TOML; or else unknown fields (with the nearest
/// known name), fields that are missing, wrong kinds of value, values out of range, and values that do not fit each other.
pub fn parse(text: &str) -> Result<Scene, Vec<SceneFault>> {
    let (root, errors) = DeTable::parse_recoverable(text);
    if !errors.is_empty() {
        return Err(syntax_faults(text, &errors));
    }
    let mut values = template(wind_method(root.get_ref()));
    let mut walk = Walk { text, faults: Vec::new(), species: species_template(text, &values, root.get_ref()) };
    walk.table(&mut values, root.get_ref(), root.span(), "");

    let scene = Scene::deserialize(values).map_err(|error| vec![SceneFault::spanning(text, 0..0, "", error.message())])?;
    let unsound = walk.faults.len();
    for Misfit { fields, message } in cross_checks(&scene) {
        let already_faulty = walk.faults[..unsound].iter().any(|fault| fields.iter().any(|field| overlap(&fault.path, field)));
        if !already_faulty {
            walk.faults.push(SceneFault::at(text, &fields[0], message));
        }
    }
    walk.faults.sort_by_key(|fault| (fault.line, fault.column));
    if walk.faults.is_empty() { Ok(scene) } else { Err(walk.faults) }
}

/// The first error of each line; what follows on the same line is seldom more than its echo.
fn syntax_faults(text: &str, errors: &[toml::de::Error]) -> Vec<SceneFault> {
    let mut faults: Vec<_> = errors
        .iter()
        .map(|error| SceneFault::spanning(text, error.span().unwrap_or(0..0), "", format!("not TOML: {}", error.message())))
        .collect();
    faults.sort_by_key(|fault| (fault.line, fault.column));
    faults.dedup_by_key(|fault| fault.line);
    faults
}

/// The wind's method that a file names; what the file leaves unsaid follows from it.
fn wind_method(root: &DeTable<'_>) -> WindMethod {
    let wind = root.get("wind").and_then(|wind| wind.get_ref().as_table());
    let word = wind.and_then(|wind| wind.get("method")).and_then(|method| method.get_ref().as_str());
    word.and_then(|word| Value::from(word).try_into().ok()).unwrap_or(WindMethod::Staggered)
}

/// A scene with all its fields, so that their names and kinds need no second list.
fn template(method: WindMethod) -> toml::Table {
    let scene = Scene {
        summary: String::new(),
        seed: 1,
        tick_hz: 60.0,
        patches: Default::default(),
        terrain: TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [1.0; 2], level_m: 0.1, base_m: 0.0 },
        wind: Wind::of(method),
        grass: Default::default(),
        plants: Default::default(),
        species: Vec::new(),
        bend: Default::default(),
        natural_wind: Default::default(),
        objects: Default::default(),
        drawn_winds: Vec::new(),
        camera: Default::default(),
        light: Default::default(),
    };
    toml::Table::try_from(scene).unwrap_or_default()
}

/// One section of the list of sections at `path`, with all its fields.
fn section_template(path: &str) -> Value {
    let section = match path {
        "drawn_winds" => Value::try_from(DrawnWind::new(WindShape::Outward, vec![[0.0; 2]])),
        _ => Value::try_from(Primitive::new(PrimitiveKind::Uniform, [0.0; 3])),
    };
    section.unwrap_or_else(|_| toml::Table::new().into())
}

/// One section `[[species]]` with all its fields: what it leaves unsaid is as in a file's own `[grass]` and `[plants]`.
fn species_template(text: &str, values: &toml::Table, root: &DeTable<'_>) -> Value {
    // Faults in those two sections are told when the file itself is walked through.
    let mut walk = Walk { text, faults: Vec::new(), species: toml::Table::new().into() };
    let mut section = |name: &str| {
        let mut section = values[name].clone();
        if let Some(found) = root.get(name) {
            walk.value(&mut section, found.get_ref(), found.span(), name);
        }
        section
    };
    let grass = Grass::deserialize(section("grass")).unwrap_or_default();
    let plants = Plants::deserialize(section("plants")).unwrap_or_default();
    Value::try_from(Species::new("", 1, &grass, &plants)).unwrap_or_else(|_| toml::Table::new().into())
}

/// Puts a file's values in the place of the template's, and keeps what does not agree with it or with [`FIELDS`].
struct Walk<'t> {
    text: &'t str,
    faults: Vec<SceneFault>,
    /// A section `[[species]]` that says nothing.
    species: Value,
}

impl Walk<'_> {
    fn fault(&mut self, span: Range<usize>, path: &str, message: impl Into<String>) {
        self.faults.push(SceneFault::spanning(self.text, span, path, message));
    }

    fn table(&mut self, values: &mut toml::Table, found: &DeTable<'_>, span: Range<usize>, path: &str) {
        for (key, value) in found {
            let path = join(path, key.get_ref());
            match values.get_mut(key.get_ref().as_ref()) {
                Some(place) => self.value(place, value.get_ref(), value.span(), &path),
                None => self.fault(key.span(), &path, unknown_field(key.get_ref(), &path, values)),
            }
        }
        for key in values.keys().filter(|key| !found.contains_key(key.as_str())) {
            let path = join(path, key);
            if REQUIRED.contains(&field_of(&path).as_str()) {
                self.fault(span.clone(), &path, format!("is missing and has no default; expected {}", expectation(&values[key], &path)));
            }
        }
    }

    /// Puts a section in `places` for each of `items`.
    fn sections(&mut self, places: &mut Vec<Value>, items: &DeArray<'_>, limit: usize, span: Range<usize>, path: &str) {
        if items.len() > limit {
            return self.fault(span, path, format!("has {} sections; allowed: at most {limit}", items.len()));
        }
        places.resize(items.len(), if path == "species" { self.species.clone() } else { section_template(path) });
        for (i, (place, item)) in places.iter_mut().zip(items.iter()).enumerate() {
            self.value(place, item.get_ref(), item.span(), &format!("{path}[{i}]"));
        }
    }

    /// Puts a pair of numbers in `places` for each of `items`.
    fn places(&mut self, places: &mut Vec<Value>, items: &DeArray<'_>, allowed: Allowed, span: Range<usize>, path: &str) {
        let Allowed::Places(least, most, ..) = allowed else { return };
        if !(least..=most).contains(&items.len()) {
            let why = if least == 3 && items.len() < 3 { ", since fewer are no footprint" } else { "" };
            return self.fault(span, path, format!("has {} places; allowed: {least} to {most}{why}", items.len()));
        }
        places.clear();
        places.resize(items.len(), Value::Array(vec![Value::Float(0.0); 2]));
        for (i, (place, item)) in places.iter_mut().zip(items.iter()).enumerate() {
            self.value(place, item.get_ref(), item.span(), &format!("{path}[{i}]"));
        }
    }

    fn value(&mut self, place: &mut Value, found: &DeValue<'_>, span: Range<usize>, path: &str) {
        let allowed = allowed_of(path);
        match (place, found) {
            (Value::Table(values), DeValue::Table(table)) => self.table(values, table, span, path),
            (Value::Array(places), DeValue::Array(items)) if let Allowed::Sections(limit) = allowed => {
                self.sections(places, items, limit, span, path)
            }
            (Value::Array(places), DeValue::Array(items)) if matches!(allowed, Allowed::Places(..)) => {
                self.places(places, items, allowed, span, path)
            }
            (Value::Array(values), DeValue::Array(items)) if values.len() == items.len() => {
                for (i, (place, item)) in values.iter_mut().zip(items.iter()).enumerate() {
                    self.value(place, item.get_ref(), item.span(), &format!("{path}[{i}]"));
                }
            }
            (Value::String(place), DeValue::String(word)) => match allowed {
                Allowed::OneOf(words) if !words.contains(&word.as_ref()) => {
                    self.fault(span, path, format!("is \"{word}\"; allowed: {allowed}"));
                }
                _ => *place = word.to_string(),
            },
            (place @ (Value::Integer(_) | Value::Float(_)), DeValue::Integer(number)) => {
                let value = i64::from_str_radix(number.as_str(), number.radix()).ok();
                match value.filter(|&value| allowed.contains(value as f64)) {
                    Some(value) if place.is_integer() => *place = Value::Integer(value),
                    Some(value) => *place = Value::Float(value as f64),
                    None => self.fault(span, path, format!("is {number}; allowed: {allowed}")),
                }
            }
            (Value::Float(place), DeValue::Float(number)) => match number.as_str().parse().ok().filter(|&value| allowed.contains(value)) {
                Some(value) => *place = value,
                None => self.fault(span, path, format!("is {number}; allowed: {allowed}")),
            },
            (place, _) => self.fault(span, path, format!("is {}; expected {}", kind_of(found), expectation(place, path))),
        }
    }
}

/// What the field at `path` may hold, or where `path` ends with a place in a list, an element of it.
fn allowed_of(path: &str) -> Allowed {
    let allowed = allowed_at(&field_of(path));
    if path.ends_with(']') { allowed.of_element() } else { allowed }
}

/// The path of a field without places in lists: `wind.primitives.at_m` of `wind.primitives[2].at_m[0]`.
fn field_of(path: &str) -> String {
    path.split('[').map(|part| part.split_once(']').map_or(part, |(_, rest)| rest)).collect()
}

/// Whether one of two paths is the other or leads into it.
fn overlap(one: &str, other: &str) -> bool {
    let leads = |short: &str, long: &str| long.strip_prefix(short).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']));
    leads(one, other) || leads(other, one)
}

fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

/// Names the field that was probably meant: in the same section by likeness, or the same name in another section.
fn unknown_field(key: &str, path: &str, template: &toml::Table) -> String {
    let like = |known: &&str| strsim::jaro_winkler(key, known);
    let nearest = template.keys().map(String::as_str).filter(|known| like(known) > 0.8).max_by(|a, b| like(a).total_cmp(&like(b)));
    if let Some(known) = nearest {
        return format!("is no field of a scene; did you mean `{known}`?");
    }
    let field = field_of(path);
    let elsewhere = FIELDS.iter().map(|(known, _)| *known).find(|known| known.rsplit('.').next() == Some(key) && *known != field);
    if let Some(known) = elsewhere {
        return format!("is no field of a scene; did you mean `{known}`?");
    }
    let known: Vec<_> = template.keys().map(|known| format!("`{known}`")).collect();
    format!("is no field of a scene; known here: {}", known.join(", "))
}

fn kind_of(found: &DeValue<'_>) -> String {
    match found {
        DeValue::String(_) => "text".to_owned(),
        DeValue::Integer(number) => format!("the number {number}"),
        DeValue::Float(number) => format!("the number {number}"),
        DeValue::Boolean(truth) => truth.to_string(),
        DeValue::Datetime(_) => "a date or time".to_owned(),
        DeValue::Array(items) => format!("a list of {}", items.len()),
        DeValue::Table(_) => "a section".to_owned(),
    }
}

fn expectation(expected: &Value, path: &str) -> String {
    let (field, allowed) = (field_of(path), allowed_of(path));
    match expected {
        _ if matches!(allowed, Allowed::Sections(_)) => format!("{allowed} `[[{field}]]`"),
        _ if matches!(allowed, Allowed::Places(..)) => format!("a list of {allowed}"),
        Value::Array(items) => format!("a list of {} numbers, each {allowed}", items.len()),
        Value::Integer(_) => format!("a whole number, {allowed}"),
        Value::Float(_) => format!("a number, {allowed}"),
        Value::Table(_) => format!("a section `[{field}]`"),
        _ => allowed.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const MINIMAL: &str =
        "summary = \"s\"\n[terrain]\nheight_map = \"h.png\"\ncovering_map = \"c.png\"\npixel_m = [0.5, 1]\nlevel_m = 0.1\n";

    fn faults_of(more: &str) -> Vec<(usize, usize, String)> {
        let faults = parse(&format!("{MINIMAL}{more}")).unwrap_err();
        faults.iter().map(|fault| (fault.line, fault.column, fault.to_string())).collect()
    }

    #[test]
    fn a_minimal_scene_has_the_defaults() {
        let scene = parse(MINIMAL).unwrap();
        assert_eq!(scene.terrain.pixel_m, [0.5, 1.0]);
        assert_eq!(scene.extent_m(), [256.0, 256.0]);
        assert_eq!(scene.dt_secs(), 1.0 / 60.0);
    }

    #[test]
    fn all_faults_are_told_at_once_in_the_order_of_the_lines() {
        let faults = faults_of(
            "[wind]\ncells = [32, 8]\ntiling = \"bix\"\nviscosity_m2_per_s = nan\nsorces = 3\ntree_m = 4\n[objects]\nlimit = 2.5\n",
        );
        let expected = [
            (8, 9, "`wind.cells` is a list of 2; expected a list of 3 numbers, each 2 to 256"),
            (9, 10, "`wind.tiling` is \"bix\"; allowed: \"box\", \"patch\" or \"follow\""),
            (10, 22, "`wind.viscosity_m2_per_s` is nan; allowed: 0 to 100"),
            (11, 1, "`wind.sorces` is no field of a scene; did you mean `sources`?"),
            (12, 1, "`wind.tree_m` is no field of a scene; did you mean `plants.tree_m`?"),
            (14, 9, "`objects.limit` is the number 2.5; expected a whole number, 0 to 1024"),
        ];
        assert_eq!(faults, expected.map(|(line, column, text)| (line, column, text.to_owned())));
    }

    #[test]
    fn values_that_do_not_fit_each_other_are_told() {
        let only = |more: &str| {
            let faults = faults_of(more);
            assert_eq!(faults.len(), 1, "{faults:?}");
            faults[0].2.clone()
        };
        assert!(only("[patches]\ncells = 60\n").ends_with("a multiple of 8"));
        assert!(only("[patches]\ncount = [2048, 1]\ncell_m = 1.0\n").contains("131072 m"));
        assert!(only("[patches]\ncells = 256\nawake_limit = 4096\n").contains("33554432"));
        assert!(only("[wind]\ncells = [256, 256, 256]\n").contains("2097152"));
        assert!(only("[wind]\ncells = [2, 2, 2]\n").starts_with("`wind.sources` is 24"));
        assert!(only("[wind]\nmean_m_per_s = [30, 30]\n").contains("42.4"));
        assert_eq!(only("[objects]\nself_driving = 65\n"), "`objects.self_driving` is 65; allowed: up to `objects.limit`, 64");
    }

    #[test]
    fn text_that_is_no_toml_is_told_with_its_place() {
        let faults = parse("summary = \"s\"\n[terrain\nheight_map = \"h.png\"\n").unwrap_err();
        assert_eq!(faults[0].line, 2);
        assert!(faults[0].message.starts_with("not TOML"), "{}", faults[0].message);
    }

    proptest! {
        #[test]
        fn no_text_panics(text in "[a-z\\[\\]=\\.\"\n0-9é ]{0,80}") {
            let faults = parse(&text).unwrap_err();
            prop_assert!(!faults.is_empty());
        }

        #[test]
        fn a_scene_survives_being_written_and_read(seed in 0..i64::MAX as u64, tick in 10.0f32..240.0, spacing in 0.1f32..1000.0) {
            let mut scene = parse(MINIMAL).unwrap();
            (scene.seed, scene.tick_hz, scene.wind.spacing_m[1]) = (seed, tick, spacing);
            prop_assert_eq!(parse(&toml::to_string(&scene).unwrap()).unwrap(), scene);
        }
    }
}
