//! The built-in species as data: every species in the file must stand, droop and break as plants do, whatever its name.

use glam::Vec3;
use prairie_core::plant::flora::height_m;
use prairie_core::plant::force_field::AIR_KG_PER_M3;
use prairie_core::plant::underbrush::bearing::bears_pa;
use prairie_core::plant::underbrush::plan::{COMPONENTS_LIMIT, Plan};
use prairie_core::plant::underbrush::plant::{Forces, LookUp, Posed, Stand, posed};
use prairie_core::plant::underbrush::posture::Nodes;
use prairie_core::scene::{ComponentKind, Underbrush, parse_underbrush};
use prairie_core::wind::near_ground_fraction;
use std::sync::LazyLock;

const FILE: &str = include_str!("../../../server/scenes/species.toml");
const GRAVITY_M_PER_S2: f32 = prairie_core::GRAVITY_M_PER_S2 as f32;
const UPRIGHT: Stand = Stand { size: 1.0, heading_rad: 0.0, lean_rad: [0.0; 2] };

/// Wind at 2 m (m/s) in which a species without a stated breaking wind must not break.
const STORM_M_PER_S: f32 = 200.0;

/// A species of the file.
struct Shipped {
    species: Underbrush,
    plan: Plan,
    /// Range of the wind at 2 m (m/s) in which it breaks, from its comment: "breaks in a wind of 22..23.5 m/s at 2 m".
    breaks_m_per_s: Option<[f32; 2]>,
}

static SHIPPED: LazyLock<Vec<Shipped>> = LazyLock::new(|| {
    let comments = FILE.split("\n[[underbrush]]\n").map(|block| block.rsplit("\n\n").next().unwrap_or_default());
    let species = parse_underbrush(FILE).expect("the species that ship are valid");
    let shipped = species.into_iter().zip(comments).map(|(species, comment)| {
        let plan = Plan::new(&species, Nodes::default());
        Shipped { species, plan, breaks_m_per_s: stated(comment) }
    });
    shipped.collect()
});

/// The breaking wind stated in a comment.
fn stated(comment: &str) -> Option<[f32; 2]> {
    let comment = comment.replace("\n# ", " ");
    let (_, rest) = comment.split_once("breaks in a wind of ")?;
    let (low, high) = rest.split_once(" m/s at 2 m")?.0.split_once("..")?;
    Some([low, high].map(|number| number.parse().expect("a number")))
}

fn pose(plan: &Plan, number: u32, pressure_pa: f32) -> Vec<Posed> {
    let forces = Forces { per_mass_m_per_s2: Vec3::Y * -GRAVITY_M_PER_S2, pressure_pa: Vec3::X * pressure_pa };
    posed(plan, &plan.placed(number), UPRIGHT, forces, LookUp::Interpolated, 0)
}

fn pressure_pa(wind_m_per_s: f32) -> f32 {
    0.5 * AIR_KG_PER_M3 * wind_m_per_s * wind_m_per_s
}

/// Number of components of a plant for a planned component; 1 for the ground.
fn components_of(plan: &Plan, planned: Option<usize>) -> usize {
    planned.map_or(1, |planned| components_of(plan, plan.components[planned].on) * plan.components[planned].component.count as usize)
}

#[test]
fn every_species_has_room_for_its_offspring_and_all_its_components() {
    assert!(!SHIPPED.is_empty());
    for Shipped { species, plan, .. } in SHIPPED.iter() {
        assert!(species.reach_m > species.room_m, "{} has room for its offspring", species.name);
        assert!((0.02..=0.5).contains(&plan.settle_secs), "{} settles in {} s", species.name, plan.settle_secs);
        let asked: usize = plan.components.iter().map(|planned| components_of(plan, planned.on) * planned.component.count as usize).sum();
        assert!(asked <= COMPONENTS_LIMIT && plan.placed(1).len() == asked, "{} has {asked} components", species.name);
    }
}

#[test]
fn stalks_stand_and_leaves_droop() {
    for Shipped { species, plan, .. } in SHIPPED.iter() {
        for planned in &plan.components {
            let load = planned.weight_s2_per_m * GRAVITY_M_PER_S2;
            let fitting = if planned.component.kind == ComponentKind::Leaf { 0.5..=6.0 } else { 0.01..=1.5 };
            assert!(fitting.contains(&load), "{} of {}: {load}", planned.component.name, species.name);
        }
        for (index, planned) in plan.components.iter().enumerate() {
            let all: Vec<Posed> = (0..40).flat_map(|number| pose(plan, number, 0.0)).filter(|one| one.planned == index).collect();
            let tip = |one: &Posed| one.sections()[one.sections().len() - 1];
            let rises = all.iter().map(|one| (tip(one).end_m - one.foot_m).y / (planned.component.length_m * one.size));
            let mean_rise = rises.clone().sum::<f32>() / all.len() as f32;
            let least_rise = rises.fold(1.0, f32::min);
            let most_bend_rad = all.iter().map(|one| tip(one).direction.angle_between(one.axis)).fold(0.0, f32::max);
            let fits = match planned.component.kind {
                ComponentKind::Leaf if planned.on.is_none() => mean_rise > 0.3 && least_rise > 0.05 && most_bend_rad > 0.2,
                ComponentKind::Leaf => most_bend_rad < 1.2,
                _ => most_bend_rad < 0.5 && least_rise > 0.3,
            };
            assert!(fits, "{} of {}: {mean_rise}, {least_rise}, {most_bend_rad}", planned.component.name, species.name);
            assert!(all.iter().all(|one| one.strain < 0.2));
            let is_smooth =
                |one: &&Posed| one.sections().windows(2).all(|pair| pair[0].direction.angle_between(pair[1].direction) < 0.1745);
            let smooth = all.iter().filter(is_smooth).count();
            assert!(smooth * 10 >= all.len() * 9, "{} of {}: {smooth} of {}", planned.component.name, species.name, all.len());
        }
    }
}

#[test]
fn a_storm_breaks_the_species_that_say_so_and_no_others() {
    assert!(SHIPPED.iter().any(|shipped| shipped.breaks_m_per_s.is_some()), "no comment states a breaking wind");
    for Shipped { species, plan, breaks_m_per_s } in SHIPPED.iter() {
        // The wind at 2 m that breaks a plant, from the pressure at half its height.
        let found_m_per_s = (bears_pa(plan) / (0.5 * AIR_KG_PER_M3)).sqrt() / near_ground_fraction(0.5 * height_m(species));
        let allowed = breaks_m_per_s.unwrap_or([STORM_M_PER_S, f32::INFINITY]);
        assert!((allowed[0]..=allowed[1]).contains(&found_m_per_s), "{} breaks at {found_m_per_s} m/s, stated {allowed:?}", species.name);
    }
}

#[test]
fn a_gale_bends_stiff_stalks_and_a_car_breaks_them() {
    // Species whose first component is a breakable stalk on the ground: a gale of 16 m/s does not break it, a force that lays it over as a car does breaks it.
    let stalks = SHIPPED.iter().filter(|shipped| {
        shipped.breaks_m_per_s.is_some_and(|[low, _]| low > 21.0) && shipped.plan.components[0].component.kind == ComponentKind::Branch
    });
    let stalks: Vec<_> = stalks.collect();
    assert!(!stalks.is_empty(), "no species breaks above 21 m/s");
    for Shipped { species, plan, .. } in stalks {
        for one in (0..40).flat_map(|number| pose(plan, number, pressure_pa(16.0))).filter(|one| one.planned == 0) {
            assert!(one.strain < 1.0, "{}: {}", species.name, one.strain);
            assert!(one.sections()[one.sections().len() - 1].direction.angle_between(one.axis) > 0.1);
        }
        // To 70 degrees.
        let laid = (1..400).map(|pascals| pose(plan, 1, (20 * pascals) as f32)[0]);
        let laid = laid.into_iter().find(|one| one.sections()[one.sections().len() - 1].direction.y < 0.34).unwrap();
        assert!(laid.strain > 1.0, "{}: {}", species.name, laid.strain);
    }
}
