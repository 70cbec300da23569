//! Walk through the values of a file, which collects every fault.

use super::allowed::{Allowed, FIELDS, REQUIRED};
use super::checks::{Conflict, Conflicts};
use super::{Positions, SceneFault, template};
use std::ops::Range;
use std::rc::Rc;
use toml::de::{DeArray, DeTable, DeValue};
use toml::{Table, Value};

/// Overwrites the template's values by the file's, and collects faults against the template and [`FIELDS`].
pub(super) struct Walk<'t> {
    positions: Positions<'t>,
    /// Description of the file, such as "a scene".
    file: &'static str,
    /// Names of the top-level fields.
    top: Vec<String>,
    /// An empty section `[[species]]` with its defaults.
    species: Table,
    findings: Vec<Finding>,
}

/// A fault found during the walk.
struct Finding {
    fault: SceneFault,
    /// For an unknown field, its key and the known ones; the message is made later, for it takes long and a file may contain many.
    unknown: Option<(String, Rc<[String]>)>,
}

impl From<SceneFault> for Finding {
    fn from(fault: SceneFault) -> Self {
        Self { fault, unknown: None }
    }
}

/// Most unknown fields of a file for which the known ones are searched or listed: the first ones.
const EXPLAINED_LIMIT: usize = 100;

/// Longest key (bytes) for which a similar one is searched, far longer than all known keys.
const KEY_LIMIT: usize = 64;

impl<'t> Walk<'t> {
    /// Starts a walk through `text`, a `file` with the fields of `template`.
    pub(super) fn new(text: &'t str, file: &'static str, template: &Table) -> Self {
        let top = template.keys().cloned().collect();
        Self { positions: Positions::new(text), file, top, species: Table::new(), findings: Vec::new() }
    }

    /// Sets the defaults of a section `[[species]]`.
    pub(super) fn with_species(self, species: Table) -> Self {
        Self { species, ..self }
    }

    /// Succeeds if there are no faults; otherwise returns all, ordered by line: those found during the walk, and conflicts between fields that are
    /// valid by themselves.
    pub(super) fn judge(mut self, conflicts: Conflicts) -> Result<(), Vec<SceneFault>> {
        let is_sound =
            |conflict: &Conflict| !self.findings.iter().any(|found| conflict.fields.iter().any(|field| overlap(&found.fault.path, field)));
        let told: Vec<_> = conflicts.0.into_iter().filter(is_sound).collect();
        self.findings.extend(told.into_iter().map(|conflict| self.positions.at(&conflict.fields[0], conflict.message).into()));
        if self.findings.is_empty() {
            return Ok(());
        }
        self.findings.sort_by_key(|found| (found.fault.line, found.fault.column));
        let mut findings = std::mem::take(&mut self.findings);
        for Finding { fault, unknown } in findings.iter_mut().filter(|found| found.unknown.is_some()).take(EXPLAINED_LIMIT) {
            let (key, known) = unknown.take().unwrap_or_default();
            fault.message = self.unknown_field(&key, &fault.path, &known);
        }
        Err(findings.into_iter().map(|found| found.fault).collect())
    }

    fn fault(&mut self, span: Range<usize>, path: &str, message: impl Into<String>) {
        self.findings.push(self.positions.spanning(span, path, message).into());
    }

    /// Overwrites `values` by the fields of a section.
    pub(super) fn table(&mut self, values: &mut Table, found: &DeTable<'_>, span: Range<usize>, path: &str) {
        let mut known: Option<Rc<[String]>> = None;
        for (key, value) in found {
            let path = join(path, key.get_ref());
            if let Some(place) = values.get_mut(key.get_ref().as_ref()) {
                self.value(place, value.get_ref(), value.span(), &path);
                continue;
            }
            let known = known.get_or_insert_with(|| values.keys().cloned().collect());
            let fault = self.positions.spanning(key.span(), &path, format!("is not a field of {}", self.file));
            self.findings.push(Finding { fault, unknown: Some((key.get_ref().to_string(), known.clone())) });
        }
        for key in values.keys().filter(|key| !found.contains_key(key.as_str())) {
            let path = join(path, key);
            if REQUIRED.contains(&field_of(&path).as_str()) {
                self.fault(span.clone(), &path, format!("is missing and has no default; expected {}", expectation(&values[key], &path)));
            }
        }
    }

    /// Reads a list of sections.
    fn sections(&mut self, places: &mut Vec<Value>, items: &DeArray<'_>, allowed: Allowed, span: Range<usize>, path: &str) {
        let Allowed::Sections(least, most) = allowed else { return };
        if !(least..=most).contains(&items.len()) {
            return self.fault(span, path, format!("has {} sections; allowed: {allowed}", items.len()));
        }
        let section = if path == "species" { self.species.clone() } else { template::section(&field_of(path)) };
        places.resize(items.len(), section.into());
        for (i, (place, item)) in places.iter_mut().zip(items.iter()).enumerate() {
            self.value(place, item.get_ref(), item.span(), &format!("{path}[{i}]"));
        }
    }

    /// Reads a list of points.
    fn places(&mut self, places: &mut Vec<Value>, items: &DeArray<'_>, allowed: Allowed, span: Range<usize>, path: &str) {
        let (Allowed::Places(least, most, ..) | Allowed::Course(least, most, ..)) = allowed else { return };
        if !(least..=most).contains(&items.len()) {
            let why = if least == 3 && items.len() < 3 { ", since fewer enclose no area" } else { "" };
            return self.fault(span, path, format!("has {} points; allowed: {least} to {most}{why}", items.len()));
        }
        places.clear();
        places.resize(items.len(), Value::Array(vec![Value::Float(0.0); 2]));
        for (i, (place, item)) in places.iter_mut().zip(items.iter()).enumerate() {
            self.value(place, item.get_ref(), item.span(), &format!("{path}[{i}]"));
        }
    }

    /// Overwrites one value.
    pub(super) fn value(&mut self, place: &mut Value, found: &DeValue<'_>, span: Range<usize>, path: &str) {
        let allowed = allowed_of(path);
        match (place, found) {
            (Value::Table(values), DeValue::Table(table)) => self.table(values, table, span, path),
            (Value::Array(places), DeValue::Array(items)) if matches!(allowed, Allowed::Sections(..)) => {
                self.sections(places, items, allowed, span, path)
            }
            (Value::Array(places), DeValue::Array(items)) if matches!(allowed, Allowed::Places(..) | Allowed::Course(..)) => {
                self.places(places, items, allowed, span, path)
            }
            (Value::Array(values), DeValue::Array(items)) if values.len() == items.len() => {
                for (i, (place, item)) in values.iter_mut().zip(items.iter()).enumerate() {
                    self.value(place, item.get_ref(), item.span(), &format!("{path}[{i}]"));
                }
            }
            (Value::String(place), DeValue::String(word)) if allowed.admits(word) => *place = word.to_string(),
            (Value::String(_), DeValue::String(word)) => self.fault(span, path, format!("is \"{word}\"; allowed: {allowed}")),
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

    /// Message about an unknown field. Suggests the field that was probably meant: a similar name in the same section, or the same name in another.
    fn unknown_field(&self, key: &str, path: &str, known: &[String]) -> String {
        let (file, field) = (self.file, field_of(path));
        let like = |known: &&str| if key.len() > KEY_LIMIT { 0.0 } else { strsim::jaro_winkler(key, known) };
        let nearest = known.iter().map(String::as_str).filter(|known| like(known) > 0.8).max_by(|a, b| like(a).total_cmp(&like(b)));
        let may_stand = |known: &&str| known.split('.').next().is_some_and(|first| self.top.iter().any(|top| top == first));
        let has_name = |known: &&str| known.rsplit('.').next() == Some(key) && *known != field;
        let elsewhere = || FIELDS.iter().map(|(known, _)| *known).find(|known| may_stand(known) && has_name(known));
        if let Some(known) = nearest.or_else(elsewhere) {
            return format!("is not a field of {file}; did you mean `{known}`?");
        }
        let known: Vec<_> = known.iter().map(|known| format!("`{known}`")).collect();
        format!("is not a field of {file}; known here: {}", known.join(", "))
    }
}

/// Allowed values of the field at `path`, or of its element if `path` ends with an index.
fn allowed_of(path: &str) -> Allowed {
    let allowed = Allowed::at(&field_of(path));
    match path.strip_suffix(']').and_then(|path| path.rsplit_once('[')) {
        Some((_, index)) => allowed.of_element(index.parse().unwrap_or(0)),
        None => allowed,
    }
}

/// The path of a field without indices: `wind.primitives.at_m` for `wind.primitives[2].at_m[0]`.
fn field_of(path: &str) -> String {
    path.split('[').map(|part| part.split_once(']').map_or(part, |(_, rest)| rest)).collect()
}

/// Whether one of two paths equals the other or leads into it.
fn overlap(one: &str, other: &str) -> bool {
    let leads = |short: &str, long: &str| long.strip_prefix(short).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']));
    leads(one, other) || leads(other, one)
}

fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
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
        _ if matches!(allowed, Allowed::Sections(..)) => format!("{allowed} sections `[[{field}]]`"),
        _ if matches!(allowed, Allowed::Places(..) | Allowed::Course(..)) => format!("a list of {allowed}"),
        Value::Array(_) if matches!(Allowed::at(&field), Allowed::Course(..)) => "a point [secs, intensity]".to_owned(),
        Value::Array(items) => format!("a list of {} numbers, each {allowed}", items.len()),
        Value::Integer(_) => format!("a whole number, {allowed}"),
        Value::Float(_) => format!("a number, {allowed}"),
        Value::Table(_) => format!("a section `[{field}]`"),
        _ => allowed.to_string(),
    }
}
