//! Checks of the underbrush: the components of each plant, and the species against each other and against the grass.

use super::Conflicts;
use super::limits::{PARTS_LIMIT, SITES_LIMIT, SPECIES_LIMIT};
use crate::scene::{Component, ComponentKind, Scene, Underbrush};

/// Allowed values of an underbrush species' `cover`.
const OWN_COVER: &str = "0, not painted, or a unique ID, 1 to 252";

/// Checks the underbrush of `scene`, whose first `from_file` species come from its underbrush file.
pub(super) fn check(scene: &Scene, from_file: usize, conflicts: &mut Conflicts) {
    let Scene { underbrush, species, growth, .. } = scene;
    check_species(underbrush, from_file, conflicts);

    for (i, Underbrush { name, cover, .. }) in underbrush.iter().enumerate() {
        let Some(j) = species.iter().position(|species| species.cover == *cover) else { continue };
        let of_grass = format!("species[{j}].cover");
        if let Some(own) = i.checked_sub(from_file) {
            let message = format!("is {cover}, already used by `species[{j}]`, \"{}\"; allowed: {OWN_COVER}", species[j].name);
            conflicts.note(&[format!("underbrush[{own}].cover"), of_grass], message);
        } else {
            let message =
                format!("is {cover}, already used by `underbrush[{i}]` in `underbrush_file`, \"{name}\"; allowed: a unique ID, 1 to 252");
            conflicts.note(&[of_grass], message);
        }
    }

    let [columns, rows] = growth.sites(scene.extent_m());
    let sites = u64::from(columns) * u64::from(rows);
    if !underbrush.is_empty() && sites > SITES_LIMIT {
        let message =
            format!("is {}, which makes {columns} × {rows} sites, {sites} in all; allowed: {SITES_LIMIT} in all", growth.spacing_m);
        conflicts.note(&["growth.spacing_m", "patches.count", "patches.cells", "patches.cell_m"], message);
    }
}

/// Checks `species`; the first `from_file` come from another file and are valid by themselves.
pub(in crate::scene) fn check_species(species: &[Underbrush], from_file: usize, conflicts: &mut Conflicts) {
    if species.len() > SPECIES_LIMIT {
        let message = format!("makes {} species with those of `underbrush_file`; allowed: at most {SPECIES_LIMIT}", species.len());
        conflicts.note(&["underbrush"], message);
    }
    let told = |i: usize| match i.checked_sub(from_file) {
        Some(own) => format!("`underbrush[{own}]`"),
        None => format!("`underbrush[{i}]` in `underbrush_file`"),
    };
    for (i, later) in species.iter().enumerate().skip(from_file) {
        let path = format!("underbrush[{}]", i - from_file);
        let twin = |is_twin: &dyn Fn(&Underbrush) -> bool| species[..i].iter().position(is_twin);
        let fields = |j: usize, key: &str| {
            let earlier = j.checked_sub(from_file).map(|own| format!("underbrush[{own}].{key}"));
            std::iter::once(format!("{path}.{key}")).chain(earlier).collect::<Vec<_>>()
        };
        if let Some(j) = twin(&|earlier| earlier.name == later.name) {
            let message = format!("is \"{}\", already used by {}; allowed: a unique name", later.name, told(j));
            conflicts.note(&fields(j, "name"), message);
        }
        if let Some(j) = twin(&|earlier| earlier.cover == later.cover && later.cover > 0) {
            let message = format!("is {}, already used by {}, \"{}\"; allowed: {OWN_COVER}", later.cover, told(j), species[j].name);
            conflicts.note(&fields(j, "cover"), message);
        }
        if later.reach_m > 0.0 && later.reach_m <= later.room_m {
            let message = format!("is {}; allowed: 0 (does not spread) or more than its `room_m`, {}", later.reach_m, later.room_m);
            conflicts.note(&["reach_m", "room_m"].map(|key| format!("{path}.{key}")), message);
        }
        check_components(later, &format!("{path}.components"), conflicts);
    }
}

/// Checks the components of one species, at `path`.
fn check_components(species: &Underbrush, path: &str, conflicts: &mut Conflicts) {
    let components = &species.components;
    for (i, Component { name, from_share, to_share, .. }) in components.iter().enumerate() {
        if let Some(j) = components[..i].iter().position(|earlier| earlier.name == *name) {
            let fields = [i, j].map(|at| format!("{path}[{at}].name"));
            conflicts.note(&fields, format!("is \"{name}\", already used by `{path}[{j}]`; allowed: a unique name within the plant"));
        }
        if from_share > to_share {
            let fields = ["from_share", "to_share"].map(|key| format!("{path}[{i}].{key}"));
            conflicts.note(&fields, format!("is {from_share}; allowed: up to its `to_share`, {to_share}"));
        }
        if let Some(message) = no_branch(species, i) {
            let earlier = (0..i).flat_map(|at| ["name", "kind"].map(|key| format!("{path}[{at}].{key}")));
            let fields: Vec<_> = std::iter::once(format!("{path}[{i}].on")).chain(earlier).collect();
            conflicts.note(&fields, message);
        }
    }

    let sums = species.parts().into_iter().scan(0u64, |sum, parts| {
        *sum = sum.saturating_add(parts);
        Some(*sum)
    });
    if let Some((i, sum)) = sums.enumerate().find(|&(_, sum)| sum > PARTS_LIMIT) {
        let others = (0..=i).flat_map(|at| ["count", "on", "name", "kind"].map(|key| format!("{path}[{at}].{key}")));
        let fields: Vec<_> = std::iter::once(format!("{path}[{i}].count")).chain(others).collect();
        let message = format!(
            "is {} on each of what it stands on, which makes {sum} leaves, branches and flowers of a plant with those before it; allowed: {PARTS_LIMIT}",
            components[i].count
        );
        conflicts.note(&fields, message);
    }
}

/// The fault of the branch that the component at `index` names in `on`, if any.
fn no_branch(species: &Underbrush, index: usize) -> Option<String> {
    let on = &species.components[index].on;
    if on.is_empty() || species.branch_below(index).is_some() {
        return None;
    }
    let found = species.components.iter().position(|component| component.name == *on);
    let why = match found {
        Some(at) if at < index => format!(", which is a {}", species.components[at].kind.word()),
        Some(at) if at == index => ", which is itself".to_owned(),
        Some(_) => ", which comes later".to_owned(),
        None => ", which is not a component of its plant".to_owned(),
    };
    let before = species.components[..index].iter().filter(|component| component.kind == ComponentKind::Branch);
    let branches: Vec<_> = before.map(|branch| format!("\"{}\"", branch.name)).collect();
    let known = match branches.as_slice() {
        [] => "; no branch comes before it".to_owned(),
        known => format!(", or a branch before it, {}", known.join(", ")),
    };
    Some(format!("is \"{on}\"{why}; allowed: \"\", the ground{known}"))
}
