//! The species that ship with the server, put through the physics.

use super::bearing::bears_pa;
use super::plan::{COMPONENTS_LIMIT, Plan};
use super::plant::{Forces, LookUp, Posed, Stand, posed};
use super::posture::Nodes;
use crate::plant::flora::height_m;
use crate::plant::force_field::AIR_KG_PER_M3;
use crate::scene::{Component, ComponentKind, Underbrush};
use crate::wind::share_near_ground;
use glam::Vec3;
use std::sync::LazyLock;
use toml::{Table, Value};

const GRAVITY_M_PER_S2: f32 = 9.81;
const UPRIGHT: Stand = Stand { size: 1.0, heading_rad: 0.0, lean_rad: [0.0; 2] };

/// A section with all that it leaves unsaid.
fn filled(section: &Table, unsaid: Value) -> Table {
    let Value::Table(mut filled) = unsaid else { panic!("a section") };
    filled.extend(section.clone());
    filled
}

static SPECIES: LazyLock<Vec<(Underbrush, Plan)>> = LazyLock::new(|| {
    let file: Table = toml::from_str(include_str!("../../../../server/scenes/species.toml")).unwrap();
    assert_eq!(file.len(), 1);
    let tables = |value: &Value| value.as_array().unwrap().iter().map(|one| one.as_table().unwrap().clone()).collect::<Vec<_>>();
    let species = tables(&file["underbrush"]).into_iter().map(|mut section| {
        let components = tables(&section["components"]).into_iter();
        let unsaid = || Value::try_from(Component::new("", ComponentKind::Leaf)).unwrap();
        let components = components.map(|component| Value::Table(filled(&component, unsaid())));
        section.insert("components".to_owned(), components.collect::<Vec<_>>().into());
        let species: Underbrush = filled(&section, Value::try_from(Underbrush::new("", Vec::new())).unwrap()).try_into().unwrap();
        let plan = Plan::new(&species, Nodes::default());
        (species, plan)
    });
    species.collect()
});

fn named(name: &str) -> &'static Plan {
    &SPECIES.iter().find(|(species, _)| species.name == name).unwrap().1
}

fn pose(plan: &Plan, number: u32, wind_m_per_s: f32) -> Vec<Posed> {
    let pressure_pa = Vec3::X * (0.5 * 1.2 * wind_m_per_s * wind_m_per_s);
    let forces = Forces { per_mass_m_per_s2: Vec3::Y * -GRAVITY_M_PER_S2, pressure_pa };
    posed(plan, &plan.placed(number), UPRIGHT, forces, LookUp::Interpolated, 0)
}

#[test]
fn there_are_eight_species_within_the_limits() {
    let names: Vec<&str> = SPECIES.iter().map(|(species, _)| species.name.as_str()).collect();
    assert_eq!(names, ["meadow grass", "tall grass", "reed", "fern", "shrub", "clover", "poppy", "daisy"]);
    for (species, plan) in SPECIES.iter() {
        let shares = [species.needs, species.uptake].concat();
        assert!(shares.iter().chain([&species.light_need]).all(|share| (0.0..=1.0).contains(share)));
        assert!((0.02..=0.5).contains(&plan.settle_secs) && (0.0..=0.9).contains(&species.size_variation));
        assert!(
            (0.05..=20.0).contains(&species.room_m) && (0.05..=50.0).contains(&species.reach_m) && species.propagation_points <= 10_000
        );
        assert!(species.reach_m > species.room_m, "{} has room for its offspring", species.name);
        assert!((1..=12).contains(&species.components.len()));
        for (part, component) in plan.parts.iter().zip(&species.components) {
            assert_eq!(part.on.is_some(), !component.on.is_empty(), "{} stands on a branch before it", component.name);
            assert!((1..=32).contains(&component.count) && (1..=16).contains(&component.sections) && (3..=16).contains(&component.petals));
            assert!((0.005..=5.0).contains(&component.length_m) && (0.0005..=1.0).contains(&component.width_m));
            assert!((1e-6..=10.0).contains(&component.mass_kg) && (1e-9..=1000.0).contains(&component.stiffness_n_m2));
            assert!((0.0..=3.1).contains(&component.angle_rad) && (0.0..=1.5).contains(&component.angle_variation_rad));
            let shares = [component.from_share, component.to_share, component.length_variation / 0.9, component.tip_stiffness_share];
            assert!(shares.iter().all(|share| (0.0..=1.0).contains(share)) && component.tip_stiffness_share >= 0.01);
            assert!([component.root_rgb, component.tip_rgb].concat().iter().all(|level| (0.0..=1.0).contains(level)));
        }
        let asked: usize = plan.parts.iter().map(|part| components_of(plan, part.on) * part.component.count as usize).sum();
        assert!(asked <= COMPONENTS_LIMIT);
        assert_eq!(plan.placed(1).len(), asked);
    }
}

/// How many of a part a plant has; one ground.
fn components_of(plan: &Plan, part: Option<usize>) -> usize {
    part.map_or(1, |part| components_of(plan, plan.parts[part].on) * plan.parts[part].component.count as usize)
}

#[test]
fn stalks_stand_and_leaves_droop() {
    for (species, plan) in SPECIES.iter() {
        for part in &plan.parts {
            let load = part.weight_secs2_per_m * GRAVITY_M_PER_S2;
            let fitting = if part.component.kind == ComponentKind::Leaf { 0.5..=6.0 } else { 0.01..=1.5 };
            assert!(fitting.contains(&load), "{} of {}: {load}", part.component.name, species.name);
        }
        for (index, part) in plan.parts.iter().enumerate() {
            let all: Vec<Posed> = (0..40).flat_map(|number| pose(plan, number, 0.0)).filter(|one| one.part == index).collect();
            let tip = |one: &Posed| one.sections()[one.sections().len() - 1];
            let rises = all.iter().map(|one| (tip(one).end_m - one.foot_m).y / (part.component.length_m * one.size));
            let mean_rise = rises.clone().sum::<f32>() / all.len() as f32;
            let least_rise = rises.fold(1.0, f32::min);
            let most_bend_rad = all.iter().map(|one| tip(one).direction.angle_between(one.axis)).fold(0.0, f32::max);
            let fits = match part.component.kind {
                ComponentKind::Leaf if part.on.is_none() => mean_rise > 0.3 && least_rise > 0.05 && most_bend_rad > 0.2,
                ComponentKind::Leaf => most_bend_rad < 1.2,
                _ => most_bend_rad < 0.5 && least_rise > 0.3,
            };
            assert!(fits, "{} of {}: {mean_rise}, {least_rise}, {most_bend_rad}", part.component.name, species.name);
            assert!(all.iter().all(|one| one.strain < 0.2));
            let is_smooth =
                |one: &&Posed| one.sections().windows(2).all(|pair| pair[0].direction.angle_between(pair[1].direction) < 0.1745);
            let smooth = all.iter().filter(is_smooth).count();
            assert!(smooth * 10 >= all.len() * 9, "{} of {}: {smooth} of {}", part.component.name, species.name, all.len());
        }
    }
}

#[test]
fn a_storm_breaks_reeds_tall_grass_and_poppies_and_nothing_else() {
    // The wind at 2 m in which a plant breaks by the pressure at half its height.
    let broken_by_m_per_s =
        |(species, plan): &(Underbrush, Plan)| (bears_pa(plan) / (0.5 * AIR_KG_PER_M3)).sqrt() / share_near_ground(0.5 * height_m(species));
    let found: Vec<(&str, f32)> = SPECIES.iter().map(|one| (one.0.name.as_str(), broken_by_m_per_s(one))).collect();
    let by = |name: &str| found.iter().find(|one| one.0 == name).unwrap().1;
    assert!((22.0..23.5).contains(&by("reed")), "{found:?}");
    assert!((19.5..21.0).contains(&by("tall grass")), "{found:?}");
    assert!((15.0..16.5).contains(&by("poppy")), "{found:?}");
    assert!(by("shrub") > 200.0 && ["meadow grass", "fern", "clover", "daisy"].iter().all(|name| by(name) == f32::INFINITY), "{found:?}");
}

#[test]
fn a_gale_bends_a_reed_and_a_car_breaks_it() {
    let reed = named("reed");
    let stalks = |wind_m_per_s: f32| (0..40).flat_map(move |number| pose(reed, number, wind_m_per_s)).filter(|one| one.part == 0);
    for one in stalks(16.0) {
        assert!(one.strain < 1.0, "{}", one.strain);
        assert!(one.sections()[7].direction.angle_between(one.axis) > 0.1);
    }
    // A force that lays it over as far as a car does, to 70 degrees.
    let laid = (1..400).map(|pascals| {
        let forces = Forces { per_mass_m_per_s2: Vec3::Y * -GRAVITY_M_PER_S2, pressure_pa: Vec3::X * (20 * pascals) as f32 };
        posed(reed, &reed.placed(1), UPRIGHT, forces, LookUp::Interpolated, 0)[0]
    });
    let laid = laid.into_iter().find(|one| one.sections()[7].direction.y < 0.34).unwrap();
    assert!(laid.strain > 1.0, "{}", laid.strain);
}
