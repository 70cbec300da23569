//! Broken plants by site, and in the order in which they broke.

use crate::snapshot::BrokenPlants;
use prairie_core::wire::BrokenPlant;
use prairie_core::wire::quantise::heading_code;

pub(super) struct BrokenState {
    /// Whether the plant of each site is broken.
    is_broken: Vec<bool>,
    plants: BrokenPlants,
}

impl BrokenState {
    /// No broken plants on this number of sites.
    pub(super) fn new(sites: usize) -> Self {
        Self { is_broken: vec![false; sites], plants: BrokenPlants::default() }
    }

    pub(super) fn plants(&self) -> &BrokenPlants {
        &self.plants
    }

    /// Restores a list of broken plants; false if one of them has no site here.
    pub(super) fn restore(&mut self, plants: BrokenPlants) -> bool {
        self.is_broken.fill(false);
        self.plants = plants;
        self.plants.iter().all(|plant| match self.is_broken.get_mut(plant.site as usize) {
            Some(is_broken) => {
                *is_broken = true;
                true
            }
            None => false,
        })
    }

    pub(super) fn is_broken(&self, site: u32) -> bool {
        self.is_broken[site as usize]
    }

    /// Breaks an intact plant, which falls along a vector on the ground.
    pub(super) fn break_plant(&mut self, site: u32, along: [f32; 2]) {
        self.is_broken[site as usize] = true;
        self.plants.push(BrokenPlant { site, fall: heading_code(along) });
    }
}
