//! Checks of the underbrush: of each plant's components, and of the species against each other and against the grass.

use super::{Component, ComponentKind, Underbrush};
use crate::scene::Scene;
use crate::scene::check::Misfits;

/// Most species of underbrush in a scene.
pub const SPECIES_LIMIT: usize = 16;

/// Most components of a species.
pub const COMPONENTS_LIMIT: usize = 16;

/// Most leaves, branches and flowers of one plant.
pub const PARTS_LIMIT: u64 = crate::plant::underbrush::plan::COMPONENTS_LIMIT as u64;

/// Most sites of a world that plants may take.
pub const SITES_LIMIT: u64 = 1 << 22;

/// IDs that places painted with one species may have in the covering map.
const OWN_COVER: &str = "0, not painted, or an ID of its own, 1 to 252";

/// Notes what does not fit together in the underbrush of `scene`, whose first `from_file` species come from its underbrush file.
pub(in crate::scene) fn check(scene: &Scene, from_file: usize, misfits: &mut Misfits) {
    let Scene { underbrush, species, growth, .. } = scene;
    check_species(underbrush, from_file, misfits);

    for (i, Underbrush { name, cover, .. }) in underbrush.iter().enumerate() {
        let Some(j) = species.iter().position(|species| species.cover == *cover) else { continue };
        let of_grass = format!("species[{j}].cover");
        if let Some(own) = i.checked_sub(from_file) {
            let message = format!("is {cover}, as that of `species[{j}]`, \"{}\"; allowed: {OWN_COVER}", species[j].name);
            misfits.note(&[format!("underbrush[{own}].cover"), of_grass], message);
        } else {
            let message =
                format!("is {cover}, as that of `underbrush[{i}]` in `underbrush_file`, \"{name}\"; allowed: an ID of its own, 1 to 252");
            misfits.note(&[of_grass], message);
        }
    }

    let [columns, rows] = growth.sites(scene.extent_m());
    let sites = u64::from(columns) * u64::from(rows);
    if !underbrush.is_empty() && sites > SITES_LIMIT {
        let message =
            format!("is {}, which makes {columns} × {rows} sites, {sites} in all; allowed: {SITES_LIMIT} in all", growth.spacing_m);
        misfits.note(&["growth.spacing_m", "patches.count", "patches.cells", "patches.cell_m"], message);
    }
}

/// Notes what does not fit together in `species`, the first `from_file` of which come from another file and are sound by themselves.
pub(in crate::scene) fn check_species(species: &[Underbrush], from_file: usize, misfits: &mut Misfits) {
    if species.len() > SPECIES_LIMIT {
        let message = format!("makes {} species with those of `underbrush_file`; allowed: at most {SPECIES_LIMIT}", species.len());
        misfits.note(&["underbrush"], message);
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
            let message = format!("is \"{}\", as that of {}; allowed: a name of its own", later.name, told(j));
            misfits.note(&fields(j, "name"), message);
        }
        if let Some(j) = twin(&|earlier| earlier.cover == later.cover && later.cover > 0) {
            let message = format!("is {}, as that of {}, \"{}\"; allowed: {OWN_COVER}", later.cover, told(j), species[j].name);
            misfits.note(&fields(j, "cover"), message);
        }
        if later.reach_m > 0.0 && later.reach_m <= later.room_m {
            let message = format!(
                "is {}; allowed: 0, it does not spread, or more than its `room_m`, {}, in which none of its own comes up",
                later.reach_m, later.room_m
            );
            misfits.note(&["reach_m", "room_m"].map(|key| format!("{path}.{key}")), message);
        }
        check_components(later, &format!("{path}.components"), misfits);
    }
}

/// Notes what does not fit together in the components of one species, which stand at `path`.
fn check_components(species: &Underbrush, path: &str, misfits: &mut Misfits) {
    let components = &species.components;
    for (i, Component { name, from_share, to_share, .. }) in components.iter().enumerate() {
        if let Some(j) = components[..i].iter().position(|earlier| earlier.name == *name) {
            let fields = [i, j].map(|at| format!("{path}[{at}].name"));
            misfits.note(&fields, format!("is \"{name}\", as that of `{path}[{j}]`; allowed: a name of its own in its plant"));
        }
        if from_share > to_share {
            let fields = ["from_share", "to_share"].map(|key| format!("{path}[{i}].{key}"));
            misfits.note(&fields, format!("is {from_share}; allowed: up to its `to_share`, {to_share}"));
        }
        if let Some(message) = no_branch(species, i) {
            let earlier = (0..i).flat_map(|at| ["name", "kind"].map(|key| format!("{path}[{at}].{key}")));
            let fields: Vec<_> = std::iter::once(format!("{path}[{i}].on")).chain(earlier).collect();
            misfits.note(&fields, message);
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
        misfits.note(&fields, message);
    }
}

/// What is wrong with the branch that the component at `index` names to stand on.
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
        None => ", which is no component of its plant".to_owned(),
    };
    let before = species.components[..index].iter().filter(|component| component.kind == ComponentKind::Branch);
    let branches: Vec<_> = before.map(|branch| format!("\"{}\"", branch.name)).collect();
    let known = match branches.as_slice() {
        [] => "; no branch comes before it".to_owned(),
        known => format!(", or a branch before it, {}", known.join(", ")),
    };
    Some(format!("is \"{on}\"{why}; allowed: \"\", the ground{known}"))
}
