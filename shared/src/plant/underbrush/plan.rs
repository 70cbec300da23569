//! What a species of underbrush is made of, worked out beforehand, and which components each of its plants has.

use super::posture::{Nodes, Postures};
use super::rest::joints;
use super::strength::{broken_across, shares};
use crate::hash::hash3;
use crate::scene::{Component, ComponentKind, Underbrush};
use std::f32::consts::TAU;

/// Most components of one plant; a species that asks for more has the first of them, in the order of its sections. One bit each tells which are broken.
pub const COMPONENTS_LIMIT: usize = 64;

/// Most sections of a component.
pub const SECTIONS_LIMIT: usize = 8;

/// Diameter of a flower's stalk over that of its ring of petals.
pub(super) const STALK_SHARE: f32 = 0.06;

/// Mean width of a component over its greatest, by its outline in [`vectors`](super::vectors).
const LEAF_MEAN_WIDTH: f32 = 0.73;
const BRANCH_MEAN_WIDTH: f32 = 0.75;

/// Drag coefficients on the greatest silhouette. A stalk is a cylinder across the wind (1.1, at the Reynolds numbers 1e3 to 1e5 of stalks); leaves and
/// petals turn their edge to the wind and stream in it (reconfiguration; Vogel, Journal of Experimental Botany 40, 1989), which leaves them the less the
/// more they bend; 0.25 is a middle.
const LEAF_DRAG: f32 = 0.25;
const STALK_DRAG: f32 = 1.1;

/// A kind of component of a species, with what its bending needs.
///
/// Plants and components of other sizes are of the same shape: at size s their mass goes with s³, their rigidity with s⁴, their strength with s³. So the load
/// Λ = |R|·L²/EI that a component feels is that of `weight_secs2_per_m·s` times the force per mass and of `drag_per_pa` times the pressure of the air. A
/// branch doesn't feel what stands on it: its own mass stands for that too.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// As in the scene.
    pub component: Component,
    /// Index of the part that it stands on, before it; none for the ground.
    pub on: Option<usize>,
    /// Λ per force per mass at size 1, m·L²/EI (s²/m).
    pub weight_secs2_per_m: f32,
    /// Λ per dynamic pressure at any size, C·S·L²/EI (1/Pa), with the silhouette S and its drag coefficient C.
    pub drag_per_pa: f32,
    /// Greatest moment that its foot bears, in units of EI/L; 0 if it never breaks.
    pub strength: f32,
    /// Index of its postures among the tables of the plan.
    pub whole: usize,
    /// Index of its postures once it is broken; none if it never breaks.
    pub broken: Option<usize>,
}

/// A species of underbrush, ready to be posed.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Its kinds of component, those that others stand on before them.
    pub parts: Vec<Part>,
    /// Tables of postures; kinds that bend alike share one.
    pub tables: Vec<Postures>,
}

/// A component of a plant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Index among the parts of the plan.
    pub part: usize,
    /// Index of the component that it stands on, before it in the plant; none for the ground.
    pub on: Option<usize>,
    /// Where it stands, as a share of the length of that.
    pub at_share: f32,
    /// Its length over that of its part.
    pub size: f32,
    /// Angle of its unbent axis from the direction of what it stands on (rad).
    pub angle_rad: f32,
    /// Turn about that direction (rad).
    pub turn_rad: f32,
}

impl Plan {
    /// Works out how the components of `species` bend. A component whose `on` names no branch before it stands on the ground.
    pub fn new(species: &Underbrush, nodes: Nodes) -> Self {
        let mut tables = Tables { chains: Vec::new(), tables: Vec::new(), nodes };
        let mut parts: Vec<Part> = Vec::with_capacity(species.components.len());
        for component in &species.components {
            let branch = |part: &Part| part.component.kind == ComponentKind::Branch && part.component.name == component.on;
            let on = parts.iter().position(branch);
            parts.push(part(component, on, &mut tables));
        }
        Self { parts, tables: tables.tables }
    }

    /// Components of the plant of that number, those that others stand on before them: the same for the same number.
    ///
    /// Angles and lengths are drawn evenly from their ranges. Turns about a branch begin at its right side, so that two rows of leaflets lie in the plane of a
    /// frond; the first turn of each part on the ground is drawn too.
    pub fn placed(&self, number: u32) -> Vec<Placed> {
        let mut placed: Vec<Placed> = Vec::new();
        for (index, part) in self.parts.iter().enumerate() {
            let Component { count, from_share, to_share, length_variation, angle_rad, angle_variation_rad, turn_rad, .. } = part.component;
            let hosts: Vec<Option<usize>> = match part.on {
                None => vec![None],
                Some(on) => (0..placed.len()).filter(|&host| placed[host].part == on).map(Some).collect(),
            };
            for host in hosts {
                let first = host.map_or(0, |host| host as u32 + 1) * count;
                let first_turn_rad = if host.is_none() { TAU * share(hash3([number, index as u32, first])[2]) } else { 0.0 };
                for nth in 0..count {
                    if placed.len() == COMPONENTS_LIMIT {
                        return placed;
                    }
                    let [angle, length, _] = hash3([number, index as u32, first + nth]).map(|random| 2.0 * share(random) - 1.0);
                    let along = if count > 1 { nth as f32 / (count - 1) as f32 } else { 1.0 };
                    placed.push(Placed {
                        part: index,
                        on: host,
                        at_share: from_share + (to_share - from_share) * along,
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

/// A random number as a share, 0 to under 1.
fn share(random: u32) -> f32 {
    (random >> 8) as f32 / (1_u32 << 24) as f32
}

/// Tables made so far, and the chains of joints they are for.
struct Tables {
    chains: Vec<Vec<f64>>,
    tables: Vec<Postures>,
    nodes: Nodes,
}

impl Tables {
    fn index_of(&mut self, joints: Vec<f64>, strength_shares: &[f64]) -> usize {
        self.chains.iter().position(|chain| *chain == joints).unwrap_or_else(|| {
            self.tables.push(Postures::new(&joints, strength_shares, self.nodes));
            self.chains.push(joints);
            self.chains.len() - 1
        })
    }
}

fn part(component: &Component, on: Option<usize>, tables: &mut Tables) -> Part {
    let (joints, shares) = chain(component);
    let square_per_rigidity = component.length_m * component.length_m / component.stiffness_n_m2;
    let strength = component.strength_n_m * component.length_m / component.stiffness_n_m2;
    let broken = broken_across(&joints, &shares, f64::from(strength));
    Part {
        component: component.clone(),
        on,
        weight_secs2_per_m: component.mass_kg * square_per_rigidity,
        drag_per_pa: drag_m2(component) * square_per_rigidity,
        strength,
        whole: tables.index_of(joints, &shares),
        broken: broken.map(|joints| tables.index_of(joints, &shares)),
    }
}

/// The stiffness of the joints of a component, and what they bear as shares of what its foot does; both as in [`rest`](super::rest) and
/// [`strength`](super::strength).
pub(super) fn chain(component: &Component) -> (Vec<f64>, Vec<f64>) {
    let sections = (component.sections as usize).clamp(1, SECTIONS_LIMIT);
    let tip_share = f64::from(component.tip_stiffness_share);
    (joints(sections, tip_share), shares(sections, tip_share))
}

/// Silhouette times drag coefficient (m²): length, width and a factor for the shape; of a flower its stalk and its ring of petals.
fn drag_m2(component: &Component) -> f32 {
    let Component { length_m, width_m, .. } = *component;
    match component.kind {
        ComponentKind::Leaf => LEAF_DRAG * LEAF_MEAN_WIDTH * length_m * width_m,
        ComponentKind::Branch => STALK_DRAG * BRANCH_MEAN_WIDTH * length_m * width_m,
        ComponentKind::Flower => {
            STALK_DRAG * STALK_SHARE * length_m * width_m + LEAF_DRAG * std::f32::consts::FRAC_PI_4 * width_m * width_m
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
        let count = |part: usize| placed.iter().filter(|one| one.part == part).count();
        assert_eq!([0, 1, 2].map(count), [3, 6, 18]);
        for (index, one) in placed.iter().enumerate() {
            assert_eq!(one.on.map(|on| placed[on].part), plan.parts[one.part].on);
            assert!(one.on.is_none_or(|on| on < index));
        }
        let leaves: Vec<f32> = placed.iter().filter(|one| one.part == 2).map(|one| one.at_share).collect();
        assert_eq!(leaves[..3], [0.5, 0.75, 1.0]);
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
        assert_eq!(plan.parts.iter().map(|part| (part.whole, part.broken)).collect::<Vec<_>>(), [(0, None), (0, None), (0, Some(1))]);
        assert_eq!(plan.tables.len(), 2);
    }

    #[test]
    fn load_and_strength_are_in_units_of_the_stiffness() {
        let part = Plan::new(&bush(), NODES).parts.remove(2);
        assert!((part.weight_secs2_per_m - 0.001 * 0.4 * 0.4 / 0.001).abs() < 1e-6);
        assert!((part.drag_per_pa - 0.25 * 0.73 * 0.4 * 0.01 * 0.4 * 0.4 / 0.001).abs() < 1e-6);
        assert!((part.strength - 0.01 * 0.4 / 0.001).abs() < 1e-6);
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
