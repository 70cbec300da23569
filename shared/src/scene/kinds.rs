//! Kinds of grass of a scene: that of `[grass]` and `[plants]`, then each species in order.

use super::{Grass, Plants, Scene};
use crate::terrain::Cover;

impl Scene {
    /// Bending of each kind of grass: `[grass]`, then each species in order.
    pub fn kinds(&self) -> Vec<Grass> {
        std::iter::once(self.grass).chain(self.species.iter().map(|species| species.grass)).collect()
    }

    /// Plants of each kind, in the order of [`kinds`](Self::kinds).
    pub fn kinds_of_plants(&self) -> Vec<Plants> {
        let species = self.species.iter().map(|species| species.plants(&self.plants));
        std::iter::once(self.plants).chain(species).collect()
    }

    /// Mean height of the tallest kind of grass (m).
    pub fn tallest_m(&self) -> f32 {
        self.species.iter().map(|species| species.height_m).fold(self.plants.height_m, f32::max)
    }

    /// Index in [`kinds`](Self::kinds) of the species with the ID `id` in the covering map; 0 if there is none.
    pub fn kind_of_cover(&self, id: u8) -> u8 {
        let species = self.species.iter().position(|species| species.cover == id);
        species.map_or(0, |index| index as u8 + 1)
    }

    /// Whether grass of any kind grows on `cover`; between painted underbrush it is that of `[grass]` and `[plants]`.
    pub fn is_grass(&self, cover: Cover) -> bool {
        match cover {
            Cover::Grass => true,
            Cover::Free(id) => self.kind_of_cover(id) > 0 || self.underbrush.iter().any(|underbrush| underbrush.cover == id),
            Cover::Gap | Cover::Tree | Cover::Stone => false,
        }
    }
}
