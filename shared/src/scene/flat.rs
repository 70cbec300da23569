//! Flat sections of a scene file: the fields of nested structs are written directly in the section around them.

use super::{Grass, Scene};
use crate::bend::WaveParams;
use serde::Serialize;
use toml::{Table, Value};

impl Scene {
    /// The text of a scene file that [`parse`](super::parse) reads back as this scene.
    pub fn to_toml(&self) -> String {
        let written = toml::to_string(self).expect("a scene holds only values that TOML can write");
        let mut values: Table = written.parse().expect("a written table reads back");
        flatten(&mut values);
        values.to_string()
    }
}

/// Turns the values of a scene from nested structs into the sections of a file.
pub(super) fn flatten(scene: &mut Table) {
    if let Some(Value::Table(grass)) = scene.get_mut("grass") {
        lift(grass, "waves");
    }
    if let Some(Value::Array(species)) = scene.get_mut("species") {
        species.iter_mut().filter_map(Value::as_table_mut).for_each(flatten_species);
    }
}

/// The same for one section `[[species]]`.
pub(super) fn flatten_species(species: &mut Table) {
    lift(species, "grass");
    lift(species, "waves");
    species.remove("laid_recovery_secs");
}

/// Turns the sections of a file back into the values of a scene.
pub(super) fn nest(scene: &mut Table) {
    let laid_recovery_secs = scene.get("grass").and_then(|grass| grass.get("laid_recovery_secs")).cloned();
    if let Some(Value::Table(grass)) = scene.get_mut("grass") {
        nest_grass(grass);
    }
    let Some(Value::Array(species)) = scene.get_mut("species") else { return };
    for species in species.iter_mut().filter_map(Value::as_table_mut) {
        nest_grass(species);
        species.extend(laid_recovery_secs.iter().map(|value| ("laid_recovery_secs".to_owned(), value.clone())));
        sink(species, "grass", Grass::default());
    }
}

/// The same for the section `[grass]`.
pub(super) fn nest_grass(grass: &mut Table) {
    sink(grass, "waves", WaveParams::default());
}

/// Moves the fields of the struct `part` up into its section.
fn lift(section: &mut Table, part: &str) {
    if let Some(Value::Table(fields)) = section.remove(part) {
        section.extend(fields);
    }
}

/// Moves the fields that `example` has from a section into the struct `part`.
fn sink(section: &mut Table, part: &str, example: impl Serialize) {
    let names = Table::try_from(example).unwrap_or_default();
    let fields: Table = names.into_iter().filter_map(|(name, _)| section.remove_entry(&name)).collect();
    section.insert(part.to_owned(), Value::Table(fields));
}
