use super::super::posture::Nodes;
use super::super::vectors::{petals, vectors};
use super::*;
use crate::scene::{Component, ComponentKind, Underbrush};
use proptest::prelude::*;
use std::sync::LazyLock;

const GRAVITY: Vec3 = Vec3::new(0.0, -crate::GRAVITY_M_PER_S2 as f32, 0.0);
const UPRIGHT: Stand = Stand { size: 1.0, heading_rad: 0.0, lean_rad: [0.0; 2] };
const CALM: Forces = Forces { per_mass_m_per_s2: GRAVITY, pressure_pa: Vec3::ZERO };

/// Two stalks with a leaf and a flower on twigs.
static PLAN: LazyLock<Plan> = LazyLock::new(|| {
    let mut stalk = Component::new("stalk", ComponentKind::Branch);
    (stalk.count, stalk.sections, stalk.stiffness_n_m2, stalk.strength_n_m) = (2, 8, 0.02, 0.03);
    let mut twig = Component::new("twig", ComponentKind::Branch);
    (twig.on, twig.count, twig.from_share, twig.length_m, twig.angle_rad, twig.sections) = ("stalk".into(), 3, 0.3, 0.2, 0.9, 3);
    let mut leaf = Component::new("leaf", ComponentKind::Leaf);
    (leaf.on, leaf.count, leaf.from_share, leaf.length_m, leaf.angle_rad, leaf.stiffness_n_m2) = ("twig".into(), 4, 0.1, 0.15, 1.2, 1e-4);
    let mut flower = Component::new("flower", ComponentKind::Flower);
    (flower.on, flower.length_m, flower.width_m, flower.sections) = ("twig".into(), 0.05, 0.04, 2);
    Plan::new(&Underbrush::new("bush", vec![stalk, twig, leaf, flower]), Nodes::default())
});

fn pose(number: u32, stand: Stand, forces: Forces) -> Vec<Posed> {
    posed(&PLAN, &PLAN.placed(number), stand, forces, LookUp::Interpolated, 0)
}

prop_compose! {
    fn stands()(size in 0.3f32..1.6, heading_rad in 0.0f32..6.3, lean_rad in [-1.5f32..1.5, -1.5f32..1.5]) -> Stand {
        Stand { size, heading_rad, lean_rad }
    }
}

prop_compose! {
    fn forces()(mass in proptest::array::uniform3(-30.0f32..30.0), pressure in proptest::array::uniform3(-500.0f32..500.0)) -> Forces {
        Forces { per_mass_m_per_s2: GRAVITY + Vec3::from(mass), pressure_pa: Vec3::from(pressure) }
    }
}

proptest! {
    #[test]
    fn components_keep_their_length_and_stand_on_what_bears_them(number in any::<u32>(), stand in stands(), forces in forces(), broken in any::<u64>()) {
        let placed = PLAN.placed(number);
        for look_up in [LookUp::Nearest, LookUp::Interpolated] {
            let posed = posed(&PLAN, &placed, stand, forces, look_up, broken);
            for (one, place) in posed.iter().zip(&placed) {
                let section_m = PLAN.components[one.planned].component.length_m * one.size / one.sections().len() as f32;
                let mut from_m = one.foot_m;
                for section in one.sections() {
                    prop_assert!(((section.end_m - from_m).length() - section_m).abs() < 1e-6);
                    prop_assert!(section.direction.dot(section.side).abs() < 1e-5 && (section.side.length() - 1.0).abs() < 1e-5);
                    prop_assert!(section.end_m.y > -1e-6, "above the ground");
                    from_m = section.end_m;
                }
                prop_assert!(one.axis.dot(one.towards).abs() < 1e-5);
                match place.on {
                    None => prop_assert_eq!(one.foot_m, Vec3::ZERO),
                    Some(on) => {
                        let host = &posed[on];
                        let mut nodes = vec![host.foot_m];
                        nodes.extend(host.sections().iter().map(|section| section.end_m));
                        let off = |ends: &[Vec3]| (one.foot_m - ends[0]).length() + (one.foot_m - ends[1]).length() - (ends[1] - ends[0]).length();
                        prop_assert!(nodes.windows(2).map(off).fold(f32::MAX, f32::min) < 1e-6);
                        prop_assert!((place.at_fraction < 1.0) || one.foot_m == nodes[nodes.len() - 1]);
                    }
                }
            }
        }
    }

    #[test]
    fn vectors_are_across_the_axis_and_fewer_keep_foot_and_tip(number in any::<u32>(), stand in stands(), forces in forces()) {
        for one in pose(number, stand, forces) {
            let planned = &PLAN.components[one.planned];
            for every in [1, 2, 4, 8] {
                let vectors = vectors(planned, &one, every);
                prop_assert_eq!(vectors.len(), one.sections().len().div_ceil(every) + 1);
                for set in &vectors[1..] {
                    let along = set.axis_m.normalize();
                    prop_assert!(set.left_m.dot(along).abs() < 1e-6 && set.right_m.dot(along).abs() < 1e-6 && set.left_m == -set.right_m);
                }
                let tip_m = one.foot_m + vectors.iter().map(|set| set.axis_m).sum::<Vec3>();
                prop_assert!((tip_m - one.sections()[one.sections().len() - 1].end_m).length() < 1e-6);
                prop_assert_eq!(vectors[0].axis_m, Vec3::ZERO);
            }
        }
    }

    #[test]
    fn a_plant_turns_with_its_heading(number in any::<u32>(), heading_rad in 0.0f32..6.3) {
        let turn = Quat::from_rotation_y(-heading_rad);
        for (one, turned) in pose(number, UPRIGHT, CALM).iter().zip(pose(number, Stand { heading_rad, ..UPRIGHT }, CALM)) {
            for (section, turned) in one.sections().iter().zip(turned.sections()) {
                prop_assert!((turn * section.end_m - turned.end_m).length() < 1e-4);
            }
        }
    }
}

#[test]
fn leaves_droop_and_wind_carries_them_along() {
    let tips =
        |forces: Forces| pose(1, UPRIGHT, forces).iter().map(|one| one.sections()[one.sections().len() - 1].end_m).collect::<Vec<_>>();
    let weightless = Forces { per_mass_m_per_s2: Vec3::ZERO, pressure_pa: Vec3::ZERO };
    let [free, calm, windy] = [weightless, CALM, Forces { per_mass_m_per_s2: GRAVITY, pressure_pa: Vec3::new(20.0, 0.0, 0.0) }].map(tips);
    for ((free, calm), windy) in free.iter().zip(&calm).zip(&windy) {
        assert!(calm.y < free.y && windy.x > calm.x, "{free} {calm} {windy}");
    }
}

#[test]
fn a_pressed_plant_leans_as_the_grass_does() {
    let mean = |posed: &[Posed]| posed.iter().filter(|one| one.planned == 0).map(|one| one.axis).sum::<Vec3>() / 2.0;
    let upright = mean(&pose(5, UPRIGHT, CALM));
    for (lean_rad, turn) in [([0.0, 0.8], Quat::from_rotation_x(0.8)), ([0.8, 0.0], Quat::from_rotation_z(-0.8))] {
        assert!((mean(&pose(5, Stand { lean_rad, ..UPRIGHT }, CALM)) - turn * upright).length() < 1e-6);
    }
}

#[test]
fn each_stands_a_turn_on_from_the_one_before_as_headings_go() {
    let headings = |posed: &[Posed]| [0, 1].map(|stalk| posed[stalk].axis.x.atan2(-posed[stalk].axis.z));
    let off = |a: f32, b: f32| ((a - b).sin(), (a - b).cos() - 1.0);
    let is_small = |(sine, cosine): (f32, f32)| sine.abs() < 1e-3 && cosine.abs() < 1e-3;
    let [first, second] = headings(&pose(4, UPRIGHT, CALM));
    assert!(is_small(off(second, first + PLAN.components[0].component.turn_rad)), "{first} and {second}");
    let [turned, _] = headings(&pose(4, Stand { heading_rad: 0.5, ..UPRIGHT }, CALM));
    assert!(is_small(off(turned, first + 0.5)), "{first} and {turned}");
}

#[test]
fn a_storm_breaks_a_stalk_and_what_is_broken_lies() {
    let strain = |pressure: f32| {
        let forces = Forces { per_mass_m_per_s2: GRAVITY, pressure_pa: Vec3::new(pressure, 0.0, 0.0) };
        pose(2, UPRIGHT, forces)[0].strain
    };
    assert!(strain(0.0) < 0.3 && strain(30.0) > strain(10.0) && strain(400.0) > 1.0, "{} {}", strain(0.0), strain(400.0));
    let broken = posed(&PLAN, &PLAN.placed(2), UPRIGHT, CALM, LookUp::Interpolated, 1);
    let height = |one: &Posed| one.sections()[7].end_m.y;
    assert!(height(&broken[0]) < 0.1 && height(&broken[1]) > 0.3, "{} and {}", height(&broken[0]), height(&broken[1]));
}

#[test]
fn a_larger_plant_bends_more_under_its_weight() {
    let off = |size: f32| {
        let stalk = pose(5, Stand { size, ..UPRIGHT }, CALM)[0];
        (stalk.sections()[7].direction - stalk.axis).length()
    };
    let ratio = off(1.5) / off(1.0);
    assert!((1.4..1.6).contains(&ratio), "{ratio}");
}

#[test]
fn a_breath_of_air_strains_a_stalk_by_half_its_force_times_its_length() {
    let breath = Forces { per_mass_m_per_s2: Vec3::ZERO, pressure_pa: Vec3::X };
    for one in pose(6, UPRIGHT, breath).iter().filter(|one| one.planned == 0) {
        let moment_n_m = 1.1 * 0.75 * 0.4 * 0.01 * 0.2 * Vec3::X.cross(one.axis).length();
        assert!((one.strain / (moment_n_m / 0.03) - 1.0).abs() < 0.02, "{}", one.strain);
    }
}

#[test]
fn a_flower_has_its_petals_about_its_tip() {
    let posed = pose(3, UPRIGHT, CALM);
    let flower = posed.iter().find(|one| one.planned == 3).unwrap();
    let petals = petals(&PLAN.components[3], flower);
    assert_eq!(petals.len(), 6);
    let radius_m = 0.02 * flower.size;
    assert!(petals.iter().all(|petal| (petal.axis_m.length() - radius_m).abs() < 1e-6 && petal.axis_m.dot(petal.left_m).abs() < 1e-8));
    let sum = petals.iter().map(|petal| petal.axis_m).sum::<Vec3>();
    assert!(sum.normalize().dot(flower.sections()[1].direction) > 0.999, "all about the stalk");
    assert!(super::super::vectors::petals(&PLAN.components[0], &posed[0]).is_empty());
}
