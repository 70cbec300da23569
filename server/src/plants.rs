//! The underbrush that objects break, for good (004 §3.2).
//!
//! A component that is pressed to lean by θ is bent over its lower half: the moment at its foot is then 2·θ·EI/L. So a plant breaks when an object that
//! moves passes over its site, the grass there is bent by θ, and 2·θ exceeds the strength of any component that it stands on. Wind and wash alone break
//! nothing.

use crate::bend::Meadow;
use crate::bend::air::GroundWind;
use crate::bend::contact::STANDING_M_PER_S;
use shared::plant::flora::Flora;
use shared::plant::underbrush::plan::Plan;
use std::sync::Arc;

/// The plants of a world, and which of them are broken.
pub struct Plants {
    flora: Option<Flora>,
    /// Bend beyond which each species breaks (rad).
    bears_rad: Vec<f32>,
    /// Whether the plant of each site is broken.
    is_broken: Vec<bool>,
    broken: Arc<Vec<u32>>,
}

impl Plants {
    /// Whole plants.
    pub fn new(flora: Option<Flora>) -> Self {
        let bears_rad = flora.iter().flat_map(|flora| flora.plans()).map(bears_rad).collect();
        let sites = flora.as_ref().map_or(0, |flora| flora.grown().sites.total());
        Self { flora, bears_rad, is_broken: vec![false; sites], broken: Arc::default() }
    }

    /// What grows; none where nothing does.
    pub fn flora(&self) -> Option<&Flora> {
        self.flora.as_ref()
    }

    /// Sites of the broken plants, in the order of their breaking, in one step in that of the objects. It only grows; a holder keeps it as it was.
    pub fn broken(&self) -> &Arc<Vec<u32>> {
        &self.broken
    }

    /// Breaks what the newest step of `meadow` pressed too far. Costs something only where an object moves over the grass.
    pub fn step(&mut self, dt_secs: f32, meadow: &Meadow, wind: &GroundWind) {
        let Some(flora) = &self.flora else { return };
        let grown = flora.grown();
        let moving = meadow.contacts().iter().filter(|contact| contact.swath.way_m() > STANDING_M_PER_S * dt_secs);
        for leg in moving.flat_map(|contact| contact.swath.legs()) {
            let [low_m, high_m] = leg.cover().bounds_m();
            for plant in grown.in_rectangle(low_m, high_m) {
                let at_m = grown.sites.place_m(plant.site);
                let is_broken = &mut self.is_broken[plant.site as usize];
                let bears_rad = self.bears_rad[usize::from(plant.species)];
                if !*is_broken && leg.passage(at_m).is_some() && meadow.bend_rad(at_m, wind) > bears_rad {
                    *is_broken = true;
                    Arc::make_mut(&mut self.broken).push(plant.site);
                }
            }
        }
    }
}

/// Bend beyond which the weakest component on the ground breaks (rad); none does where it is infinite.
fn bears_rad(plan: &Plan) -> f32 {
    let on_ground = plan.parts.iter().filter(|part| part.on.is_none() && part.strength > 0.0);
    on_ground.map(|part| 0.5 * part.strength).fold(f32::INFINITY, f32::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::plant::underbrush::posture::Nodes;
    use shared::scene::{Component, ComponentKind, Underbrush};

    #[test]
    fn a_species_bears_what_its_weakest_foot_does() {
        let component = |name: &str, on: &str, strength_n_m| {
            let component = Component::new(name, ComponentKind::Branch);
            Component { on: on.to_owned(), length_m: 2.0, stiffness_n_m2: 4.0, strength_n_m, ..component }
        };
        let bears_rad = |components: Vec<Component>| bears_rad(&Plan::new(&Underbrush::new("reed", components), Nodes::default()));
        let [strong, weak] = [("stalk", 3.0), ("shoot", 1.6)].map(|(name, strength_n_m)| component(name, "", strength_n_m));
        // Half of M·L/EI.
        assert!((bears_rad(vec![strong.clone(), weak]) - 0.4).abs() < 1e-6);
        assert!((bears_rad(vec![strong, component("twig", "stalk", 0.1)]) - 0.75).abs() < 1e-6, "what stands on a branch does not count");
        assert_eq!(bears_rad(vec![component("stalk", "", 0.0)]), f32::INFINITY);
    }
}
