//! Plan of a species of underbrush: precomputed postures, and the components of each of its plants.

use super::posture::{Nodes, Postures};
use super::rest::joints;
use super::strength::{broken_across, fractions};
use crate::hash::hash3;
use crate::scene::{Component, ComponentKind, Underbrush};
use std::f32::consts::TAU;

/// Largest number of components of one plant; further ones are dropped, in the order of the sections. A bit mask records which are broken.
pub const COMPONENTS_LIMIT: usize = 64;

/// Largest number of sections of a component.
pub const SECTIONS_LIMIT: usize = 16;

/// Shortest and longest time constant of a species (s).
const SETTLE_SECS: [f32; 2] = [0.01, 10.0];

/// Diameter of a flower's stalk relative to that of its ring of petals.
pub(super) const STALK_FRACTION: f32 = 0.06;

/// Mean width of a component relative to its largest, by its outline in [`vectors`](super::vectors).
const LEAF_MEAN_WIDTH: f32 = 0.73;
const BRANCH_MEAN_WIDTH: f32 = 0.75;

/// Drag coefficients on the largest silhouette. A stalk is a cylinder across the wind (1.1, at the Reynolds numbers 1e3 to 1e5 of stalks). Leaves and
/// petals turn their edge to the wind and stream in it (reconfiguration; Vogel 1989), which lowers the coefficient the more they bend; 0.25 is an
/// average.
pub(in crate::plant) const LEAF_DRAG: f32 = 0.25;
const STALK_DRAG: f32 = 1.1;

/// A kind of component of a species, with the constants of its bending.
///
/// Plants and components of other sizes have the same shape: at size s their mass scales with s³, their rigidity with s⁴, their strength with s³. So
/// the load Λ = |R|·L²/EI on a component is `weight_s2_per_m·s` times the force per mass plus `drag_per_pa` times the pressure of the air. A
/// branch does not feel the components that it carries: its own mass includes them.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedComponent {
    /// The component as in the scene.
    pub component: Component,
    /// Index of the planned component that carries it, which comes before it; `None` for the ground.
    pub on: Option<usize>,
    /// Λ per force per mass at size 1, m·L²/EI (s²/m).
    pub weight_s2_per_m: f32,
    /// Λ per dynamic pressure at any size, C·S·L²/EI (1/Pa), with the silhouette S and its drag coefficient C.
    pub drag_per_pa: f32,
    /// Moment at which its base breaks, in units of EI/L; 0 if it never breaks.
    pub strength: f32,
    /// Index of its postures among the tables of the plan.
    pub whole: usize,
    /// Index of its postures once it is broken; `None` if it never breaks.
    pub broken: Option<usize>,
}

/// A species of underbrush with its posture tables.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Its kinds of component; carriers come before the components that they carry.
    pub components: Vec<PlannedComponent>,
    /// Posture tables; kinds that bend alike share one.
    pub tables: Vec<Postures>,
    /// Time constant τ with which it follows a force (s), 0.01..=10: as in the scene, or 1/ω₁ of the longest component on the ground, from
    /// [`frequency_rad_per_s`].
    pub settle_secs: f32,
}

/// A component of a plant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Index among the components of the plan.
    pub planned: usize,
    /// Index of the component that carries it, which comes before it in the plant; `None` for the ground.
    pub on: Option<usize>,
    /// Position along the carrier, as a fraction of its length.
    pub at_fraction: f32,
    /// Its length relative to that of its planned component.
    pub size: f32,
    /// Angle of its unbent axis from the direction of its carrier (rad).
    pub angle_rad: f32,
    /// Rotation about that direction (rad).
    pub turn_rad: f32,
}

impl Plan {
    /// Precomputes the bending of the components of `species`. A component whose `on` names no earlier branch is on the ground.
    pub fn new(species: &Underbrush, nodes: Nodes) -> Self {
        let mut tables = Tables { chains: Vec::new(), tables: Vec::new(), nodes };
        let mut components: Vec<PlannedComponent> = Vec::with_capacity(species.components.len());
        for (index, component) in species.components.iter().enumerate() {
            components.push(planned(component, species.branch_below(index), &mut tables));
        }
        let settle_secs = if species.settle_secs > 0.0 { species.settle_secs } else { 1.0 / slowest_rad_per_s(&components) };
        Self { components, tables: tables.tables, settle_secs: settle_secs.clamp(SETTLE_SECS[0], SETTLE_SECS[1]) }
    }

    /// Components of the plant with this number, carriers first: the same for the same number.
    ///
    /// Angles and lengths are uniform in their ranges. Rotations about a branch start at its right side, so that two rows of leaflets are in the
    /// plane of a frond; the first rotation of each kind of component on the ground is random, too.
    pub fn placed(&self, number: u32) -> Vec<Placed> {
        let mut placed: Vec<Placed> = Vec::new();
        for (index, planned) in self.components.iter().enumerate() {
            let Component { count, length_variation, angle_rad, angle_variation_rad, turn_rad, .. } = planned.component;
            let hosts: Vec<Option<usize>> = match planned.on {
                None => vec![None],
                Some(on) => (0..placed.len()).filter(|&host| placed[host].planned == on).map(Some).collect(),
            };
            for host in hosts {
                let first = host.map_or(0, |host| host as u32 + 1) * count;
                let first_turn_rad = if host.is_none() { TAU * fraction(hash3([number, index as u32, first])[2]) } else { 0.0 };
                for nth in 0..count {
                    if placed.len() == COMPONENTS_LIMIT {
                        return placed;
                    }
                    let [angle, length, _] = hash3([number, index as u32, first + nth]).map(|random| 2.0 * fraction(random) - 1.0);
                    placed.push(Placed {
                        planned: index,
                        on: host,
                        at_fraction: at_fraction(&planned.component, nth),
                        size: 1.0 + length_variation * length,
                        angle_rad: (angle_rad + angle_variation_rad * angle).abs(),
                        turn_rad: first_turn_rad + turn_rad * nth as f32,
                    });
                }
            }
        }
        placed
    }
}

/// Position of the nth of a component, as a fraction of the length of its branch.
fn at_fraction(component: &Component, nth: u32) -> f32 {
    let Component { count, from_share, to_share, .. } = *component;
    let along = if count > 1 { nth as f32 / (count - 1) as f32 } else { 1.0 };
    from_share + (to_share - from_share) * along
}

/// First natural frequency ω₁ (rad/s) of a component that is clamped at its base and carries a mass at its tip.
///
/// Dunkerley's rule, `1/ω₁² = (m/12.36 + M/3)·L³/EI`, is exact for the bare uniform cantilever, 3.516·√(EI/(m·L³)), and for the mass alone, and at
/// worst 0.3 % low between them. A rigidity that falls to the fraction t at the tip is taken to soften it to (3 + t)/4; with both it is within 4 %.
pub fn frequency_rad_per_s(component: &Component, tip_kg: f32) -> f32 {
    let Component { length_m, stiffness_n_m2, mass_kg, tip_stiffness_share, .. } = *component;
    let moved_kg = mass_kg / (3.516 * 3.516) + tip_kg / 3.0;
    (0.25 * (3.0 + tip_stiffness_share) * stiffness_n_m2 / (length_m * length_m * length_m * moved_kg)).sqrt()
}

/// Frequency ω₁ of the longest component on the ground (rad/s), including carried components: a mass at the fraction s of its length counts at the tip
/// with the square of `(3s² − s³)/2`, the shape under a load at the tip.
fn slowest_rad_per_s(components: &[PlannedComponent]) -> f32 {
    let on_ground = components.iter().enumerate().filter(|(_, planned)| planned.on.is_none());
    let Some((longest, host)) = on_ground.max_by(|(_, a), (_, b)| a.component.length_m.total_cmp(&b.component.length_m)) else {
        return 1.0;
    };
    // Mass (kg) of one component of each kind, including those that it carries, which follow it in the list.
    let mut whole_kg: Vec<f32> = components.iter().map(|planned| planned.component.mass_kg).collect();
    let mut tip_kg = 0.0;
    for (index, PlannedComponent { component, on, .. }) in components.iter().enumerate().rev() {
        let Some(on) = *on else { continue };
        whole_kg[on] += component.count as f32 * whole_kg[index];
        if on == longest {
            let moves = (0..component.count).map(|nth| at_fraction(component, nth)).map(|s| 0.5 * s * s * (3.0 - s));
            tip_kg += whole_kg[index] * moves.map(|by| by * by).sum::<f32>();
        }
    }
    frequency_rad_per_s(&host.component, tip_kg)
}

/// A random number as a fraction, 0 to under 1.
fn fraction(random: u32) -> f32 {
    (random >> 8) as f32 / (1_u32 << 24) as f32
}

/// Tables made so far, and the joints that they belong to.
struct Tables {
    chains: Vec<Vec<f64>>,
    tables: Vec<Postures>,
    nodes: Nodes,
}

impl Tables {
    fn index_of(&mut self, joints: Vec<f64>, strength_fractions: &[f64]) -> usize {
        self.chains.iter().position(|chain| *chain == joints).unwrap_or_else(|| {
            self.tables.push(Postures::new(&joints, strength_fractions, self.nodes));
            self.chains.push(joints);
            self.chains.len() - 1
        })
    }
}

fn planned(component: &Component, on: Option<usize>, tables: &mut Tables) -> PlannedComponent {
    let (joints, fractions) = chain(component);
    let square_per_rigidity = component.length_m * component.length_m / component.stiffness_n_m2;
    let strength = component.strength_n_m * component.length_m / component.stiffness_n_m2;
    let broken = broken_across(&joints, &fractions, f64::from(strength));
    PlannedComponent {
        component: component.clone(),
        on,
        weight_s2_per_m: component.mass_kg * square_per_rigidity,
        drag_per_pa: drag_m2(component) * square_per_rigidity,
        strength,
        whole: tables.index_of(joints, &fractions),
        broken: broken.map(|joints| tables.index_of(joints, &fractions)),
    }
}

/// Stiffness of the joints of a component, and their strength relative to the base; both as in [`rest`](super::rest) and
/// [`strength`](super::strength).
pub(super) fn chain(component: &Component) -> (Vec<f64>, Vec<f64>) {
    let sections = (component.sections as usize).clamp(1, SECTIONS_LIMIT);
    let tip_fraction = f64::from(component.tip_stiffness_share);
    (joints(sections, tip_fraction), fractions(sections, tip_fraction))
}

/// Silhouette times drag coefficient (m²): length, width and a shape factor; for a flower its stalk and its ring of petals.
fn drag_m2(component: &Component) -> f32 {
    let Component { length_m, width_m, .. } = *component;
    match component.kind {
        ComponentKind::Leaf => LEAF_DRAG * LEAF_MEAN_WIDTH * length_m * width_m,
        ComponentKind::Branch => STALK_DRAG * BRANCH_MEAN_WIDTH * length_m * width_m,
        ComponentKind::Flower => {
            STALK_DRAG * STALK_FRACTION * length_m * width_m + LEAF_DRAG * std::f32::consts::FRAC_PI_4 * width_m * width_m
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::plant::{Forces, LookUp, Stand, posed};
    use super::super::vectors::vectors;
    use super::*;
    use glam::Vec3;
    use proptest::prelude::*;

    const NODES: Nodes = Nodes { angles: 3, loads: 3 };

    fn bush() -> Underbrush {
        let mut stalk = Component::new("stalk", ComponentKind::Branch);
        stalk.count = 3;
        let mut twig = Component::new("twig", ComponentKind::Branch);
        (twig.on, twig.count, twig.from_share, twig.to_share) = ("stalk".into(), 2, 0.4, 0.8);
        let mut leaf = Component::new("leaf", ComponentKind::Leaf);
        (leaf.on, leaf.count, leaf.from_share) = ("twig".into(), 3, 0.5);
        leaf.strength_n_m = 0.01;
        Underbrush::new("bush", vec![stalk, twig, leaf])
    }

    #[test]
    fn every_branch_bears_its_own() {
        let plan = Plan::new(&bush(), NODES);
        let placed = plan.placed(7);
        let count = |planned: usize| placed.iter().filter(|one| one.planned == planned).count();
        assert_eq!([0, 1, 2].map(count), [3, 6, 18]);
        for (index, one) in placed.iter().enumerate() {
            assert_eq!(one.on.map(|on| placed[on].planned), plan.components[one.planned].on);
            assert!(one.on.is_none_or(|on| on < index));
        }
        let leaves: Vec<f32> = placed.iter().filter(|one| one.planned == 2).map(|one| one.at_fraction).collect();
        assert_eq!(leaves[..3], [0.5, 0.75, 1.0]);
        let mut sizes: Vec<f32> = placed.iter().filter(|one| one.planned == 2).map(|one| one.size).collect();
        sizes.sort_by(f32::total_cmp);
        sizes.dedup();
        assert_eq!(sizes.len(), 18, "no branch has the leaves of another");
    }

    #[test]
    fn plants_differ_by_their_number_alone() {
        let plan = Plan::new(&bush(), NODES);
        assert_eq!(plan.placed(3), plan.placed(3));
        assert_ne!(plan.placed(3), plan.placed(4));
        let all: Vec<Placed> = (0..200).flat_map(|number| plan.placed(number)).collect();
        let sizes = all.iter().map(|one| one.size);
        assert!(sizes.clone().all(|size| (0.8..=1.2).contains(&size)));
        assert!(sizes.clone().fold(1.0, f32::min) < 0.81 && sizes.fold(1.0, f32::max) > 1.19);
        assert!(all.iter().all(|one| (0.2..=0.4001).contains(&one.angle_rad)));
    }

    #[test]
    fn kinds_that_bend_alike_share_a_table() {
        let plan = Plan::new(&bush(), NODES);
        assert_eq!(
            plan.components.iter().map(|planned| (planned.whole, planned.broken)).collect::<Vec<_>>(),
            [(0, None), (0, None), (0, Some(1))]
        );
        assert_eq!(plan.tables.len(), 2);
    }

    #[test]
    fn load_and_strength_are_in_units_of_the_stiffness() {
        let planned = Plan::new(&bush(), NODES).components.remove(2);
        assert!((planned.weight_s2_per_m - 0.001 * 0.4 * 0.4 / 0.001).abs() < 1e-6);
        assert!((planned.drag_per_pa - 0.25 * 0.73 * 0.4 * 0.01 * 0.4 * 0.4 / 0.001).abs() < 1e-6);
        assert!((planned.strength - 0.01 * 0.4 / 0.001).abs() < 1e-6);
        let drag_per_pa = |kind| Plan::new(&Underbrush::new("one", vec![Component::new("one", kind)]), NODES).components[0].drag_per_pa;
        assert!((drag_per_pa(ComponentKind::Branch) - 1.1 * 0.75 * 0.004 * 160.0).abs() < 1e-5);
        assert!(
            (drag_per_pa(ComponentKind::Flower) - (1.1 * 0.06 * 0.004 + 0.25 * std::f32::consts::FRAC_PI_4 * 1e-4) * 160.0).abs() < 1e-5
        );
    }

    #[test]
    fn the_air_meets_the_outline_of_a_component() {
        for (kind, drag) in [(ComponentKind::Leaf, LEAF_DRAG), (ComponentKind::Branch, STALK_DRAG)] {
            let component = Component { sections: 16, length_variation: 0.0, ..Component::new("one", kind) };
            let plan = Plan::new(&Underbrush::new("one", vec![component.clone()]), NODES);
            let stand = Stand { size: 1.0, heading_rad: 0.0, lean_rad: [0.0; 2] };
            let weightless = Forces { per_mass_m_per_s2: Vec3::ZERO, pressure_pa: Vec3::ZERO };
            let one = posed(&plan, &plan.placed(1), stand, weightless, LookUp::Nearest, 0)[0];
            let outline = vectors(&plan.components[0], &one, 1);
            let silhouette_m2: f32 =
                outline.windows(2).map(|pair| pair[1].axis_m.length() * (pair[0].right_m.length() + pair[1].right_m.length())).sum();
            let found_m2 = drag_m2(&component) / drag;
            assert!((found_m2 / silhouette_m2 - 1.0).abs() < 0.01, "{found_m2} m² of {silhouette_m2} m²");
        }
    }

    /// First natural frequency of a chain of `count` sections with their masses in the middle and a mass at the tip, in units of √(EI/(m·L³)): power
    /// iteration on the shape bent by its own inertia.
    fn chain_frequency(tip_fraction: f64, tip_mass: f64) -> f64 {
        let count = 80;
        let section = 1.0 / f64::from(count);
        let joints = crate::plant::underbrush::rest::joints(count as usize, tip_fraction);
        // In units of the tip's displacement.
        let (mut shape, mut square) = (vec![0.5; count as usize], 0.0);
        for _ in 0..30 {
            let (mut force, mut moment) = (tip_mass, 0.0);
            let mut moments: Vec<f64> = shape
                .iter()
                .rev()
                .map(|moves| {
                    moment += section * (force + 0.5 * section * moves);
                    force += section * moves;
                    moment
                })
                .collect();
            moments.reverse();
            let (mut angle_rad, mut end) = (0.0, 0.0);
            for ((moves, moment), joint) in shape.iter_mut().zip(moments).zip(&joints) {
                angle_rad += moment / joint;
                *moves = end + 0.5 * section * angle_rad;
                end += section * angle_rad;
            }
            shape.iter_mut().for_each(|moves| *moves /= end);
            square = 1.0 / end;
        }
        square.sqrt()
    }

    #[test]
    fn a_species_swings_as_its_longest_component_does() {
        let mut reed = Component::new("reed", ComponentKind::Branch);
        (reed.length_m, reed.mass_kg, reed.stiffness_n_m2, reed.tip_stiffness_share) = (1.5, 0.03, 2.0, 1.0);
        let unit_rad_per_s = (2.0_f32 / (0.03 * 1.5 * 1.5 * 1.5)).sqrt();
        let settle_secs = |components: Vec<Component>| Plan::new(&Underbrush::new("reed", components), NODES).settle_secs;
        let mut leaf = Component::new("leaf", ComponentKind::Leaf);
        leaf.length_m = 0.3;
        // The published value of a bare uniform cantilever; shorter components have no effect.
        assert!((settle_secs(vec![leaf.clone(), reed.clone()]) * 3.516 * unit_rad_per_s - 1.0).abs() < 0.01);
        // Four times as stiff is twice as fast; carried components make it slower.
        let stiffer = Component { stiffness_n_m2: 8.0, ..reed.clone() };
        assert!((settle_secs(vec![stiffer]) / settle_secs(vec![reed.clone()]) - 0.5).abs() < 1e-5);
        let plume = Component { on: "reed".into(), count: 3, mass_kg: 0.02, ..leaf };
        let wanted = (0.03 / 12.362 + 0.06 / 3.0_f32).sqrt() / (0.03_f32 / 12.362).sqrt();
        assert!((settle_secs(vec![reed.clone(), plume.clone()]) / settle_secs(vec![reed.clone()]) / wanted - 1.0).abs() < 1e-3);
        let low = Component { from_share: 0.1, to_share: 0.1, ..plume };
        assert!(settle_secs(vec![reed.clone(), low]) < 1.01 * settle_secs(vec![reed.clone()]));

        let told =
            |settle: f32| Plan::new(&Underbrush { settle_secs: settle, ..Underbrush::new("reed", vec![reed.clone()]) }, NODES).settle_secs;
        assert_eq!([told(0.7), told(1e-9)], [0.7, 0.01]);
        let rod = Component { stiffness_n_m2: 1000.0, mass_kg: 1e-6, length_m: 0.005, ..reed.clone() };
        assert_eq!(settle_secs(vec![rod]), 0.01, "no faster than a species may be told to be");
    }

    #[test]
    fn the_frequency_is_as_close_to_that_of_a_chain_as_it_says() {
        for (tip_fraction, within) in [(1.0_f32, 0.004), (0.5, 0.04), (0.2, 0.04), (0.1, 0.04)] {
            for tip_mass in [0.0_f32, 0.1, 0.5, 2.0, 100.0] {
                let rod = Component {
                    length_m: 1.0,
                    mass_kg: 1.0,
                    stiffness_n_m2: 1.0,
                    tip_stiffness_share: tip_fraction,
                    ..Component::new("a", ComponentKind::Leaf)
                };
                let off =
                    f64::from(frequency_rad_per_s(&rod, tip_mass)) / chain_frequency(f64::from(tip_fraction), f64::from(tip_mass)) - 1.0;
                assert!(off.abs() < within, "{off} at {tip_fraction} and {tip_mass}");
            }
        }
    }

    proptest! {
        #[test]
        fn a_plant_has_its_limit(counts in proptest::collection::vec(1_u32..=32, 1..8), number in any::<u32>()) {
            let components = counts.iter().enumerate().map(|(i, &count)| {
                let mut component = Component::new(&i.to_string(), ComponentKind::Branch);
                component.count = count;
                component.on = i.checked_sub(1).map_or(String::new(), |on| on.to_string());
                component
            });
            let plan = Plan::new(&Underbrush::new("bush", components.collect()), NODES);
            let asked = counts.iter().fold((0_usize, 1_usize), |(sum, last), &count| (sum + last * count as usize, last * count as usize)).0;
            prop_assert_eq!(plan.placed(number).len(), asked.min(COMPONENTS_LIMIT));
        }
    }
}
