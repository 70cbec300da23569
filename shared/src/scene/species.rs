//! Kinds of grass that a scene tells apart.

use super::{Grass, Plants, Scene};
use crate::terrain::Cover;
use serde::{Deserialize, Serialize};

/// One kind of grass: the ID that it has in the covering map, its size, colours and swing, and how it bends. What a section leaves unsaid is as in
/// `[grass]` and `[plants]`, which are the kind of ID 255.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Species {
    /// Name, one for each, not empty. Required.
    pub name: String,
    /// Its ID in the covering map, one for each. Required, allowed 1..=252.
    pub cover: u8,
    /// Mean height of a blade (m). Default 0.8 or as in `[plants]`, allowed 0.02..=5.
    pub height_m: f32,
    /// Colour at the root, linear RGB. Default (0.03, 0.07, 0.015) or as in `[plants]`, allowed 0..=1 each.
    pub root_rgb: [f32; 3],
    /// Colour at the tip, linear RGB. Default (0.3, 0.4, 0.09) or as in `[plants]`, allowed 0..=1 each.
    pub tip_rgb: [f32; 3],
    /// Natural frequency of a blade of mean height (Hz). Default 1.55 or as in `[plants]`, allowed 0.05..=50.
    pub swing_hz: f32,
    /// Base speed at which θ spreads (m/s). Default 1 or as in `[grass]`, allowed 0..=50.
    pub c0_m_per_s: f32,
    /// How the bending speed adds to the speed of θ (m/rad). Default 0.05 or as in `[grass]`, allowed 0..=10.
    pub mu_m_per_rad: f32,
    /// Speed at which the bending velocity spreads (m/s). Default 1 or as in `[grass]`, allowed 0..=50.
    pub c_omega_m_per_s: f32,
    /// Damping rate of θ (1/s). Default 6 or as in `[grass]`, allowed 0..=200.
    pub theta_damping_per_s: f32,
    /// Damping rate of the bending velocity (1/s). Default 6 or as in `[grass]`, allowed 0..=200.
    pub omega_damping_per_s: f32,
    /// Restoring rate (1/s²); stiffer plants also droop less. Default 1.2 or as in `[grass]`, allowed 0..=10000.
    pub stiffness_per_s2: f32,
    /// Largest bend on flat land (rad). Default 1.45 or as in `[grass]`, allowed 0.1..=1.57.
    pub theta_max_rad: f32,
    /// Bend that a wind of 10 m/s sustains (rad). Default 0.5 or as in `[grass]`, allowed 0..=1.5.
    pub wind_bend_rad: f32,
    /// How long the tip's bend comes after the root's (s). Default 0.12 or as in `[grass]`, allowed 0..=1.
    pub lag_secs: f32,
    /// Share of that lag while the grass rises again. Default 0.4 or as in `[grass]`, allowed 0..=1.
    pub recovery_lag_share: f32,
    /// Segments that bend one after the other, from the root up; 1 is stiff, short grass. Default 3 or as in `[grass]`, allowed 1..=6.
    pub segments: u32,
}

impl Species {
    /// A kind that differs from that of `grass` and `plants` in its name and its ID alone.
    pub fn new(name: &str, cover: u8, grass: &Grass, plants: &Plants) -> Self {
        Self {
            name: name.to_owned(),
            cover,
            height_m: plants.height_m,
            root_rgb: plants.root_rgb,
            tip_rgb: plants.tip_rgb,
            swing_hz: plants.swing_hz,
            c0_m_per_s: grass.c0_m_per_s,
            mu_m_per_rad: grass.mu_m_per_rad,
            c_omega_m_per_s: grass.c_omega_m_per_s,
            theta_damping_per_s: grass.theta_damping_per_s,
            omega_damping_per_s: grass.omega_damping_per_s,
            stiffness_per_s2: grass.stiffness_per_s2,
            theta_max_rad: grass.theta_max_rad,
            wind_bend_rad: grass.wind_bend_rad,
            lag_secs: grass.lag_secs,
            recovery_lag_share: grass.recovery_lag_share,
            segments: grass.segments,
        }
    }

    /// How it bends: its own constants, and those of `base` that no species has for itself.
    pub fn grass(&self, base: &Grass) -> Grass {
        let mut grass = *base;
        grass.c0_m_per_s = self.c0_m_per_s;
        grass.mu_m_per_rad = self.mu_m_per_rad;
        grass.c_omega_m_per_s = self.c_omega_m_per_s;
        grass.theta_damping_per_s = self.theta_damping_per_s;
        grass.omega_damping_per_s = self.omega_damping_per_s;
        grass.stiffness_per_s2 = self.stiffness_per_s2;
        grass.theta_max_rad = self.theta_max_rad;
        grass.wind_bend_rad = self.wind_bend_rad;
        grass.lag_secs = self.lag_secs;
        grass.recovery_lag_share = self.recovery_lag_share;
        grass.segments = self.segments;
        grass
    }

    /// What grows there: size, colours and swing of its own, the rest of `base`.
    pub fn plants(&self, base: &Plants) -> Plants {
        Plants { height_m: self.height_m, root_rgb: self.root_rgb, tip_rgb: self.tip_rgb, swing_hz: self.swing_hz, ..*base }
    }
}

impl Scene {
    /// How each kind of grass bends: that of `[grass]`, then each species in order.
    pub fn kinds(&self) -> Vec<Grass> {
        let species = self.species.iter().map(|species| species.grass(&self.grass));
        std::iter::once(self.grass).chain(species).collect()
    }

    /// What grows of each kind, in the order of [`kinds`](Self::kinds).
    pub fn kinds_of_plants(&self) -> Vec<Plants> {
        let species = self.species.iter().map(|species| species.plants(&self.plants));
        std::iter::once(self.plants).chain(species).collect()
    }

    /// Height of the tallest kind of grass (m).
    pub fn tallest_m(&self) -> f32 {
        self.species.iter().map(|species| species.height_m).fold(self.plants.height_m, f32::max)
    }

    /// Index in [`kinds`](Self::kinds) of what has the ID `id` in the covering map; 0 where no species has it.
    pub fn kind_of_cover(&self, id: u8) -> u8 {
        let species = self.species.iter().position(|species| species.cover == id);
        species.map_or(0, |index| index as u8 + 1)
    }

    /// Whether grass of any kind grows where the covering map says `cover`; between painted underbrush it is that of `[grass]` and `[plants]`.
    pub fn is_grass(&self, cover: Cover) -> bool {
        match cover {
            Cover::Grass => true,
            Cover::Free(id) => self.kind_of_cover(id) > 0 || self.underbrush.iter().any(|underbrush| underbrush.cover == id),
            Cover::Gap | Cover::Tree | Cover::Stone => false,
        }
    }
}
