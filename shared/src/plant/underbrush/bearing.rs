//! Breaking loads of a species: the bend and the wind pressure at which one of its components on the ground breaks (Endo et al. 2003, §§3.2, 4).

use super::plan::{Plan, PlannedComponent, chain};
use super::rest::Load;
use super::strength::breaks;
use crate::GRAVITY_M_PER_S2;
use std::f64::consts::PI;

/// Largest pressure considered (Pa), that of a wind of 1300 m/s.
const MOST_PA: f64 = 1e6;
/// Number of bisections of the breaking pressure, down to the rounding of an `f32`.
const HALVINGS: u32 = 40;

/// Bend at which the weakest component on the ground breaks (rad); infinite if none does. A component pressed to a lean of θ is bent over its lower
/// half, with the moment 2·θ·EI/L at its base.
pub fn bears_rad(plan: &Plan) -> f32 {
    on_ground(plan).map(|planned| 0.5 * planned.strength).fold(f32::INFINITY, f32::min)
}

/// Dynamic pressure of the air (Pa) at which the weakest component on the ground breaks under its weight and the drag, at unit size; infinite if none
/// does. It leans by its mean angle, with the wind or against it, whichever breaks it sooner, as both occur around a plant. A stiff one breaks sooner
/// with the wind, helped by its weight; a limp one against it, as it is bent over further.
pub fn bears_pa(plan: &Plan) -> f32 {
    on_ground(plan).map(component_bears_pa).fold(f32::INFINITY, f32::min)
}

fn on_ground(plan: &Plan) -> impl Iterator<Item = &PlannedComponent> {
    plan.components.iter().filter(|planned| planned.on.is_none() && planned.strength > 0.0)
}

/// By bisection, as the strain grows with the pressure.
fn component_bears_pa(planned: &PlannedComponent) -> f32 {
    let (joints, fractions) = chain(&planned.component);
    let lean_rad = f64::from(planned.component.angle_rad);
    let weight = f64::from(planned.weight_s2_per_m) * GRAVITY_M_PER_S2;
    let is_broken = |pressure_pa: f64| {
        let drag = f64::from(planned.drag_per_pa) * pressure_pa;
        let (load, load_rad) = (Load { spread: weight.hypot(drag), tip: 0.0 }, drag.atan2(weight));
        [lean_rad, -lean_rad].iter().any(|lean_rad| {
            let unbent_rad = (lean_rad + load_rad).abs().min(PI);
            breaks(&joints, &fractions, planned.strength.into(), load, unbent_rad).is_some()
        })
    };
    if !is_broken(MOST_PA) {
        return f32::INFINITY;
    }
    let halved = |[low, high]: [f64; 2], _| {
        let middle = 0.5 * (low + high);
        if is_broken(middle) { [low, middle] } else { [middle, high] }
    };
    (0..HALVINGS).fold([0.0, MOST_PA], halved)[0] as f32
}

#[cfg(test)]
mod tests {
    use super::super::plant::{Forces, LookUp, Posed, Stand, posed};
    use super::super::posture::Nodes;
    use super::*;
    use crate::scene::{Component, ComponentKind, Underbrush};
    use glam::Vec3;

    fn stalk(name: &str, on: &str, strength_n_m: f32) -> Component {
        let component = Component::new(name, ComponentKind::Branch);
        Component { on: on.to_owned(), length_m: 2.0, stiffness_n_m2: 4.0, strength_n_m, sections: 8, length_variation: 0.0, ..component }
    }

    fn plan(components: Vec<Component>) -> Plan {
        Plan::new(&Underbrush::new("reed", components), Nodes::default())
    }

    #[test]
    fn a_species_bears_what_its_weakest_foot_does() {
        let [strong, weak] = [("stalk", 3.0), ("shoot", 1.6)].map(|(name, strength_n_m)| stalk(name, "", strength_n_m));
        // Half of M·L/EI.
        assert!((bears_rad(&plan(vec![strong.clone(), weak.clone()])) - 0.4).abs() < 1e-6);
        let with_twig = plan(vec![strong.clone(), stalk("twig", "stalk", 0.1)]);
        assert!((bears_rad(&with_twig) - 0.75).abs() < 1e-6, "what stands on a branch does not count");
        let alone = plan(vec![strong.clone()]);
        assert_eq!(bears_pa(&with_twig), bears_pa(&alone));
        assert_eq!(bears_pa(&plan(vec![strong, weak.clone()])), bears_pa(&plan(vec![weak])));
        let everlasting = plan(vec![stalk("stalk", "", 0.0)]);
        assert_eq!((bears_rad(&everlasting), bears_pa(&everlasting)), (f32::INFINITY, f32::INFINITY));
    }

    #[test]
    fn a_stiff_stalk_bears_twice_its_strength_over_the_drag() {
        // A component that hardly bends: its drag acts at half its length, C·q·S·L/2 = M.
        let component = Component { angle_rad: 0.0, mass_kg: 1e-6, width_m: 0.01, ..stalk("stalk", "", 0.02) };
        let silhouette_m2 = 1.1 * 0.75 * component.length_m * component.width_m;
        let wanted_pa = 0.02 * 2.0 / (silhouette_m2 * component.length_m);
        let found_pa = bears_pa(&plan(vec![component.clone()]));
        assert!((found_pa / wanted_pa - 1.0).abs() < 1e-3, "{found_pa} Pa instead of {wanted_pa}");
        // At an angle its weight, 1 N here, contributes W·L/2·sin a, and the drag has a shorter arm, L/2·cos a.
        let leaning = Component { angle_rad: 0.3, mass_kg: 0.001 / GRAVITY_M_PER_S2 as f32, ..component };
        let wanted_pa = (0.02 - 0.001 * 0.3f32.sin()) / (silhouette_m2 * 0.3f32.cos());
        let found_pa = bears_pa(&plan(vec![leaning]));
        assert!((found_pa / wanted_pa - 1.0).abs() < 3e-3, "{found_pa} Pa instead of {wanted_pa}");
    }

    #[test]
    fn a_limp_stalk_bears_any_wind() {
        // All sections along the wind: the moment at the foot is at most its joint's, 16·EI/L times a right angle, over the ¾ of its load that rotate it.
        let limp = |strength_n_m| bears_pa(&plan(vec![Component { angle_rad: 0.0, ..stalk("stalk", "", strength_n_m) }]));
        assert!(limp(2.0 * 33.6) == f32::INFINITY && limp(2.0 * 28.0).is_finite());
    }

    #[test]
    fn plants_break_in_the_tables_where_they_do_here() {
        for (strength_n_m, angle_rad) in [(0.8, 0.1), (2.0, 0.3), (4.0, 0.1), (6.0, 0.6)] {
            let component = Component {
                count: 8,
                angle_rad,
                angle_variation_rad: 0.0,
                turn_rad: std::f32::consts::TAU / 8.0,
                ..stalk("stalk", "", strength_n_m)
            };
            let plan = plan(vec![component]);
            let strain = |pressure_pa: f32| {
                let forces = Forces { per_mass_m_per_s2: Vec3::Y * -GRAVITY_M_PER_S2 as f32, pressure_pa: Vec3::X * pressure_pa };
                let stand = Stand { size: 1.0, heading_rad: 0.0, lean_rad: [0.0; 2] };
                let all = (0..8).flat_map(|number| posed(&plan, &plan.placed(number), stand, forces, LookUp::Interpolated, 0));
                all.map(|one: Posed| one.strain).fold(0.0, f32::max)
            };
            let at_limit = strain(bears_pa(&plan));
            assert!((0.95..1.03).contains(&at_limit), "strain {at_limit} at the limit of {strength_n_m} N·m at {angle_rad} rad");
        }
    }
}
