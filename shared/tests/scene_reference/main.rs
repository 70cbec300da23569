//! The doc comments of the scene's structs, the table of allowed values, the defaults, the README and the JSON Schema agree.

mod documented;
mod schema;

use documented::{EXPLAINED, Field, documented, list, sections};
use prairie_core::scene::{Allowed, FIELDS, REQUIRED, parse};
use std::fmt::Write;
use std::path::Path;

/// Whether [`FIELDS`] lists a field by itself, not with `[grass]` or `[plants]`.
fn is_listed(field: &Field) -> bool {
    match field.path.strip_prefix("species.") {
        Some(name) => ["name", "cover"].contains(&name),
        None => true,
    }
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
        + "[[models]]\nname = 'a'\ncover = 2\nmodel = 'rock'\n"
        + "[[drawn_winds]]\nshape = 'swirl'\npath_m = [[1.0, 2.0]]\n[[lights]]\nat_m = [1.0, 2.0, 3.0]\n"
        + "[[race.gates]]\nat_m = [1.0, 2.0]\nheading_rad = 0.5\n[[race.gates]]\nat_m = [8.0, 2.0]\nheading_rad = 3.5\n";
    parse(&text).unwrap().to_toml().parse().unwrap()
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

/// Paths of all fields that are not sections, without indices in lists.
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

/// A path without indices in lists, as in the table of fields.
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
    let listed: Vec<_> = documented().into_iter().filter(is_listed).map(|field| field.path).collect();
    assert_eq!(listed, FIELDS.map(|(path, _)| path.to_owned()));
    let mut serialised = paths_in(&complete(), "");
    let mut fields: Vec<_> = documented().into_iter().map(|field| field.path).collect();
    serialised.sort();
    fields.sort();
    assert_eq!(serialised, fields);
}

#[test]
fn doc_comments_give_the_checked_range_and_the_true_default() {
    let mut scene = complete();
    for field in documented() {
        let (path, allowed) = (field.path.as_str(), Allowed::at(&field.path));
        if let Allowed::Range(low, high) = allowed {
            let stated = numbers(after(&field.doc, "allowed ").unwrap_or_else(|| panic!("{path} states no range")));
            assert_eq!(stated[..2], [low, high], "{path}: {}", field.doc);
        }
        if let Allowed::Places(least, most, low, high) = allowed {
            let stated = numbers(after(&field.doc, "allowed ").unwrap());
            assert_eq!(stated[..4], [least as f64, most as f64, low, high], "{path}: {}", field.doc);
        }
        if let Allowed::Course(least, most, [first, last], [low, high]) = allowed {
            let stated = numbers(after(&field.doc, "allowed ").unwrap());
            assert_eq!(stated[..6], [least as f64, most as f64, first, last, low, high], "{path}: {}", field.doc);
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
            let known = EXPLAINED.iter().any(|(known, ..)| *known == words);
            assert!(known || words.iter().all(|word| field.doc.contains(&format!("`{word}`"))), "{path}: {}", field.doc);
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
    for Field { path, .. } in documented() {
        let path = path.as_str();
        let allowed = Allowed::at(path);
        let (Allowed::Range(low, high) | Allowed::Places(.., low, high) | Allowed::Course(.., [low, high], _)) = allowed else { continue };
        let mut absurd =
            vec![f64::NAN.into(), f64::INFINITY.into(), f64::NEG_INFINITY.into(), (high * 2.0 + 1e6).into(), (low - 1e6).into()];
        absurd.push(toml::Value::Integer(i64::MIN));
        absurd.push(toml::Value::String("many".to_owned()));
        absurd.push(toml::Value::Boolean(true));
        for number in absurd {
            let mut scene = complete();
            let value = value_at(&mut scene, path);
            *value = match allowed {
                Allowed::Course(..) => vec![vec![number.clone(); 2]; 2].into(),
                _ => with_number(value, &number),
            };
            let faults = parse(&scene.to_string()).expect_err(&format!("{path} may be {number}"));
            assert!(faults.iter().all(|fault| field_of(&fault.path) == path), "{path} = {number}: {faults:?}");
            assert!(faults.iter().all(|fault| fault.line > 0 && fault.message.contains("allowed") || fault.message.contains("expected")));
        }
    }
}

#[test]
fn listed_words_are_accepted_and_all_others_rejected() {
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
fn the_largest_seed_is_shown_to_the_last_digit() {
    let faults = parse("seed = -1").unwrap_err();
    let fault = faults.iter().find(|fault| fault.path == "seed").unwrap();
    assert_eq!(fault.message, format!("is -1; allowed: 0 to {}", i64::MAX));
}

#[test]
fn exactly_the_required_fields_are_required() {
    let fields = FIELDS.iter().map(|(path, _)| (*path).to_owned());
    for path in fields.chain(sections()) {
        let path = path.as_str();
        let mut scene = complete();
        let (section, key) = section_of(&mut scene, path);
        section.remove(key);
        let missing = parse(&scene.to_string()).err().map(|faults| field_of(&faults[0].path));
        assert_eq!(missing.as_deref(), REQUIRED.contains(&path).then_some(path));
    }
}

#[test]
fn the_readme_shows_every_field() {
    let (mut tables, mut explained) = (String::new(), Vec::new());
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
        let words = FIELDS.iter().find_map(|(path, allowed)| match allowed {
            Allowed::OneOf(words) if *path == field.path => Some(*words),
            _ => None,
        });
        let words = words.and_then(|words| list(words, &mut explained)).unwrap_or_default();
        writeln!(tables, "| `{key}` | {}{words} |", field.doc).unwrap();
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
