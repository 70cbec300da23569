//! Species of underbrush: plants made of leaves, branches and flowers (004 §3).

pub(super) mod check;

pub use check::{COMPONENTS_LIMIT, PARTS_LIMIT, SITES_LIMIT, SPECIES_LIMIT};

use super::wind::words;
use serde::{Deserialize, Serialize};

words! {
    /// What a component of a plant is.
    ComponentKind {
        /// A blade: two borders about its axis, widest in its lower half.
        Leaf = "leaf",
        /// A stalk that other components stand on.
        Branch = "branch",
        /// A ring of petals on a stalk of its own.
        Flower = "flower",
    }
}

/// Leaves, branches or flowers of one kind: their number, where they stand, and what they are made of.
///
/// Unbent they are straight; gravity and their stiffness give them their shape at rest, section by section (004 §3.2).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Component {
    /// Name, one for each in its plant, not empty. Required.
    pub name: String,
    /// `leaf`, `branch` or `flower`. Required.
    pub kind: ComponentKind,
    /// Name of the branch that it stands on, which comes before it; empty for the ground. Default empty.
    pub on: String,
    /// How many stand on the ground or on each of those branches. Default 1, allowed 1..=32, and at most 64 on a plant of all components.
    pub count: u32,
    /// Where the lowest of them stands, as a share of the branch's length. Default 1, allowed 0..=1.
    pub from_share: f32,
    /// Where the highest stands; those between stand evenly. Default 1, allowed 0..=1.
    pub to_share: f32,
    /// Length (m). Default 0.4, allowed 0.005..=5.
    pub length_m: f32,
    /// Random share of the length, plus or minus. Default 0.2, allowed 0..=0.9.
    pub length_variation: f32,
    /// Width of a leaf where it is widest, diameter of a branch at its foot, or diameter of a flower's ring of petals (m). Default 0.01, allowed 0.0005..=1.
    pub width_m: f32,
    /// Petals of a flower. Default 6, allowed 3..=16.
    pub petals: u32,
    /// Straight sections that it bends in; of 8 the tip is 0.3 % of the length at most off that of a smooth shape, of 16 it is 0.08 %. Default 8, allowed
    /// 1..=16.
    pub sections: u32,
    /// Mass (kg); of a flower with its petals. Default 0.001, allowed 0.000001..=10.
    pub mass_kg: f32,
    /// Flexural rigidity EI at its foot (N·m²). Default 0.001, allowed 0.000000001..=1000.
    pub stiffness_n_m2: f32,
    /// Rigidity at its tip as a share of that at its foot; linear between. Default 0.5, allowed 0.01..=1.
    pub tip_stiffness_share: f32,
    /// Bending moment at which it breaks for good (N·m); 0: never. Default 0, allowed 0..=10000.
    pub strength_n_m: f32,
    /// Angle of its unbent axis from what it stands on (rad): from upright on the ground, from the branch's own direction on a branch. Default 0.3, allowed
    /// 0..=3.1.
    pub angle_rad: f32,
    /// Random part of that angle, plus or minus (rad). Default 0.1, allowed 0..=1.5.
    pub angle_variation_rad: f32,
    /// Turn about what it stands on from each to the next (rad). Default 2.4, the golden angle; allowed −6.3..=6.3.
    pub turn_rad: f32,
    /// Colour at its foot, linear RGB. Default (0.04, 0.09, 0.02), allowed 0..=1 each.
    pub root_rgb: [f32; 3],
    /// Colour at its tip, or of petals, linear RGB. Default (0.2, 0.33, 0.07), allowed 0..=1 each.
    pub tip_rgb: [f32; 3],
}

impl Component {
    /// A component that differs from the defaults in its name and its kind alone.
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

/// A species of underbrush: what its plants are made of, and what they need to grow (004 §5.2).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Underbrush {
    /// Name, one for each, not empty. Required.
    pub name: String,
    /// ID in the covering map of places that are painted with it, where it alone grows; 0: it is not painted. Default 0, allowed 0..=252.
    pub cover: u8,
    /// Time constant τ with which its plants follow a force (s), 004 Eq. (5); 0: 1/ω₁ of the longest component on the ground, from its rigidity, mass and
    /// length and what it carries. What comes out below 0.01 is 0.01, above 10 it is 10. Default 0, allowed 0..=10.
    pub settle_secs: f32,
    /// Share of its unbent size that plants differ by, plus or minus. Default 0.25, allowed 0..=0.9.
    pub size_variation: f32,
    /// Distance that it keeps from plants of its own species (m); from others half the sum of both. Default 0.5, allowed 0.05..=20.
    pub room_m: f32,
    /// How far from a plant its offspring come up at most (m). Default 1.5, allowed 0..=50, and more than `room_m`, in which none of its own comes up; 0: it
    /// does not spread.
    pub reach_m: f32,
    /// Places from which it spreads, drawn by lot from those that suit it. Default 40, allowed 0..=10000.
    pub propagation_points: u32,
    /// Concentration of each of the three nutrients that it needs to come up. Default (0.2, 0.2, 0.2), allowed 0..=1 each.
    pub needs: [f32; 3],
    /// What a plant takes up of each. Default (0.1, 0.1, 0.1), allowed 0..=1 each.
    pub uptake: [f32; 3],
    /// Light that it needs to come up, as a share of open daylight; taller neighbours shade it. Default 0.3, allowed 0..=1.
    pub light_need: f32,
    /// Its leaves, branches and flowers, each a section `[[underbrush.components]]`. Required, allowed 1..=16 sections.
    pub components: Vec<Component>,
}

impl Underbrush {
    /// A species of `components` that differs from the defaults in its name alone.
    pub fn new(name: &str, components: Vec<Component>) -> Self {
        Self {
            name: name.to_owned(),
            cover: 0,
            settle_secs: 0.0,
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

    /// Index of the branch that the component at `index` stands on, which comes before it; none on the ground, and where there is no such branch.
    ///
    /// # Panics
    /// When there is no such component.
    pub fn branch_below(&self, index: usize) -> Option<usize> {
        let on = self.components[index].on.as_str();
        let is_it = |below: &Component| below.kind == ComponentKind::Branch && below.name == on;
        if on.is_empty() { None } else { self.components[..index].iter().position(is_it) }
    }

    /// How many of each component a plant has: its `count` times the number of the branch that it stands on.
    pub fn parts(&self) -> Vec<u64> {
        let mut parts = Vec::with_capacity(self.components.len());
        for (index, component) in self.components.iter().enumerate() {
            let below = self.branch_below(index).map_or(1, |below| parts[below]);
            parts.push(u64::from(component.count).saturating_mul(below));
        }
        parts
    }
}
