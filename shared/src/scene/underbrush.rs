//! Species of underbrush: plants made of leaves, branches and flowers (Endo et al. 2003, §3).

use super::wind::words;
use crate::plant::underbrush::posture::Nodes;
use serde::{Deserialize, Serialize};

words! {
    /// Kind of a component of a plant.
    ComponentKind {
        /// A leaf: two edges about its axis, widest in its lower half.
        Leaf = "leaf",
        /// A stalk that carries other components.
        Branch = "branch",
        /// A ring of petals on its own stalk.
        Flower = "flower",
    }
}

/// Leaves, branches or flowers of one kind: their number, position and material.
///
/// Unbent they are straight; gravity and stiffness determine their shape at rest, section by section (Endo et al. 2003, §3.2).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Component {
    /// Unique name within the plant, not empty. Required.
    pub name: String,
    /// `leaf`, `branch` or `flower`. Required.
    pub kind: ComponentKind,
    /// Name of the branch that carries it, which must come before it; empty for the ground. Default empty.
    pub on: String,
    /// Number on the ground or on each of those branches. Default 1, allowed 1..=32, and at most 64 components on a plant in all.
    pub count: u32,
    /// Position of the lowest, as a fraction of the branch's length. Default 1, allowed 0..=1.
    pub from_share: f32,
    /// Position of the highest; the others are evenly spaced between. Default 1, allowed 0..=1.
    pub to_share: f32,
    /// Length (m). Default 0.4, allowed 0.005..=5.
    pub length_m: f32,
    /// Random fraction of the length, plus or minus. Default 0.2, allowed 0..=0.9.
    pub length_variation: f32,
    /// Largest width of a leaf, diameter of a branch at its base, or diameter of a flower's ring of petals (m). Default 0.01, allowed 0.0005..=1.
    pub width_m: f32,
    /// Number of petals of a flower. Default 6, allowed 3..=16.
    pub petals: u32,
    /// Number of straight sections; with 8 the tip is off by at most 0.3 % of the length from that of a smooth shape, with 16 by 0.08 %. Default 8,
    /// allowed 1..=16.
    pub sections: u32,
    /// Mass (kg); of a flower including its petals. Default 0.001, allowed 0.000001..=10.
    pub mass_kg: f32,
    /// Flexural rigidity EI at its base (N·m²). Default 0.001, allowed 0.000000001..=1000.
    pub stiffness_n_m2: f32,
    /// Rigidity at its tip as a fraction of that at its base; linear between. Default 0.5, allowed 0.01..=1.
    pub tip_stiffness_share: f32,
    /// Bending moment at which it breaks for good (N·m); 0: it never breaks. Default 0, allowed 0..=10000.
    pub strength_n_m: f32,
    /// Angle of its unbent axis (rad): from vertical on the ground, from the branch's direction on a branch. Default 0.3, allowed 0..=3.1.
    pub angle_rad: f32,
    /// Random part of that angle, plus or minus (rad). Default 0.1, allowed 0..=1.5.
    pub angle_variation_rad: f32,
    /// Angle around the parent between successive components (rad). Default 2.4, the golden angle; allowed −6.3..=6.3.
    pub turn_rad: f32,
    /// Colour at its base, linear RGB. Default (0.04, 0.09, 0.02), allowed 0..=1 each.
    pub root_rgb: [f32; 3],
    /// Colour at its tip, or of its petals, linear RGB. Default (0.2, 0.33, 0.07), allowed 0..=1 each.
    pub tip_rgb: [f32; 3],
}

impl Component {
    /// A component with the defaults of all but its name and kind.
    pub fn new(name: &str, kind: ComponentKind) -> Self {
        Self {
            name: name.to_owned(),
            kind,
            on: String::new(),
            count: 1,
            from_share: 1.0,
            to_share: 1.0,
            length_m: 0.4,
            length_variation: 0.2,
            width_m: 0.01,
            petals: 6,
            sections: 8,
            mass_kg: 0.001,
            stiffness_n_m2: 0.001,
            tip_stiffness_share: 0.5,
            strength_n_m: 0.0,
            angle_rad: 0.3,
            angle_variation_rad: 0.1,
            turn_rad: 2.4,
            root_rgb: [0.04, 0.09, 0.02],
            tip_rgb: [0.20, 0.33, 0.07],
        }
    }
}

/// A species of underbrush: the components of its plants, and what they need to grow (Endo et al. 2003, §5.2).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Underbrush {
    /// Unique name, not empty. Required.
    pub name: String,
    /// ID in the covering map of areas painted with it, where it alone grows; 0: it is not painted. Default 0, allowed 0..=252.
    pub cover: u8,
    /// Time constant τ with which its plants follow a force (s), Endo et al. 2003, Eq. (5); 0: 1/ω₁ of the longest component on the ground, from its
    /// rigidity, mass, length and load, limited to 0.01..=10. Default 0, allowed 0..=10.
    pub settle_secs: f32,
    /// Number of angles between its components and their load for which postures are precomputed (Endo et al. 2003, §4.2); memory and time to start
    /// grow in proportion. With 33 the tip is off by 0.2 % of the length, with 17 by 0.3 % (root mean square). Default 33, allowed 2..=65.
    pub posture_angles: u32,
    /// Number of loads for which postures are precomputed, from none to one that aligns a component with it. Default 33, allowed 2..=65.
    pub posture_loads: u32,
    /// Random variation of the unbent size, plus or minus, as a fraction. Default 0.25, allowed 0..=0.9.
    pub size_variation: f32,
    /// Smallest distance between plants of this species (m); to another species half the sum of both. Default 0.5, allowed 0.05..=20.
    pub room_m: f32,
    /// Largest distance of offspring from a plant (m). Default 1.5, allowed 0..=50, and more than `room_m`, within which no offspring comes up; 0: it
    /// does not spread.
    pub reach_m: f32,
    /// Number of points from which it spreads, drawn at random from those that suit it. Default 40, allowed 0..=10000.
    pub propagation_points: u32,
    /// Concentration of each of the three nutrients that it needs to come up. Default (0.2, 0.2, 0.2), allowed 0..=1 each.
    pub needs: [f32; 3],
    /// Uptake of each nutrient by a plant. Default (0.1, 0.1, 0.1), allowed 0..=1 each.
    pub uptake: [f32; 3],
    /// Light that it needs to come up, as a fraction of open daylight; taller neighbours shade it. Default 0.3, allowed 0..=1.
    pub light_need: f32,
    /// Its leaves, branches and flowers, each a section `[[underbrush.components]]`. Required, allowed 1..=16 sections.
    pub components: Vec<Component>,
}

impl Underbrush {
    /// A species of `components` with the defaults of all but its name.
    pub fn new(name: &str, components: Vec<Component>) -> Self {
        Self {
            name: name.to_owned(),
            cover: 0,
            settle_secs: 0.0,
            posture_angles: 33,
            posture_loads: 33,
            size_variation: 0.25,
            room_m: 0.5,
            reach_m: 1.5,
            propagation_points: 40,
            needs: [0.2; 3],
            uptake: [0.1; 3],
            light_need: 0.3,
            components,
        }
    }

    /// Size of its posture tables.
    pub fn posture_nodes(&self) -> Nodes {
        Nodes { angles: self.posture_angles as usize, loads: self.posture_loads as usize }
    }

    /// Index of the branch that carries the component at `index`, which comes before it; `None` on the ground, or if there is no such branch.
    ///
    /// # Panics
    /// When there is no such component.
    pub fn branch_below(&self, index: usize) -> Option<usize> {
        let on = self.components[index].on.as_str();
        let is_it = |below: &Component| below.kind == ComponentKind::Branch && below.name == on;
        if on.is_empty() { None } else { self.components[..index].iter().position(is_it) }
    }

    /// Number of each component on a plant: its `count` times the number of the branch that carries it.
    pub fn parts(&self) -> Vec<u64> {
        let mut parts = Vec::with_capacity(self.components.len());
        for (index, component) in self.components.iter().enumerate() {
            let below = self.branch_below(index).map_or(1, |below| parts[below]);
            parts.push(u64::from(component.count).saturating_mul(below));
        }
        parts
    }
}
