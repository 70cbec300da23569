//! Needs of a species and its effect on the sites around it, in the integers of the lattice.

use super::Sites;
use super::disc::{Disc, square_steps};
use super::nutrients::level;
use crate::scene::Underbrush;

/// A species in lattice units.
pub(super) struct Habit {
    pub(super) needs: [u16; 3],
    pub(super) uptake: [u16; 3],
    pub(super) light_need: u16,
    pub(super) propagation_points: usize,
    /// Dispersal distance of its seeds (steps), and the smallest squared distance beyond that.
    pub(super) reach: i64,
    pub(super) reach2: i64,
    /// Its exclusive area: it takes up nutrients there, and no species that needs less room comes nearer.
    pub(super) room: Disc,
    /// Species that it excludes: their bit, and the smallest squared distance allowed.
    pub(super) keeps_away: Vec<(u16, i64)>,
    /// The same by species, for those that must be absent for it to come up; 0 for the others.
    pub(super) stays_away: Vec<i64>,
    /// Area that it shades.
    pub(super) shade: Disc,
    /// Shorter species, and the fraction of light that it takes from each at the distance of its room.
    pub(super) shades: Vec<(usize, f32)>,
    /// Its room (steps).
    pub(super) room_steps: f32,
}

impl Habit {
    /// Habits of all species.
    pub(super) fn of_all(species: &[Underbrush], heights_m: &[f32], shade: f32, sites: &Sites) -> Vec<Self> {
        (0..species.len()).map(|index| Self::new(index, species, heights_m, shade, sites)).collect()
    }

    fn new(index: usize, species: &[Underbrush], heights_m: &[f32], shade: f32, sites: &Sites) -> Self {
        let own = &species[index];
        let room_steps = sites.steps(own.room_m.into());
        let apart2 = |other: &Underbrush| square_steps(0.5 * sites.steps(f64::from(own.room_m) + f64::from(other.room_m)));
        // Of two species the one that needs more room checks the distance, since it has fewer plants: before a plant of it comes up, it searches for
        // plants of the other; afterwards it closes sites to them.
        let keeps_away = |(i, other): (usize, &Underbrush)| (other.room_m <= own.room_m).then(|| (1 << i, apart2(other)));
        let stays_away = |other: &Underbrush| if other.room_m < own.room_m { apart2(other) } else { 0 };
        let taken = |i: usize| 2.0 * shade * (1.0 - heights_m[i] / heights_m[index]) * f32::from(u16::MAX);
        let shades: Vec<_> = (0..species.len()).filter(|&i| species[i].light_need > 0.0).map(|i| (i, taken(i))).collect();
        let reach_steps = sites.steps(own.reach_m.into());
        Self {
            needs: own.needs.map(|need| level(need.into())),
            uptake: own.uptake.map(|uptake| level(uptake.into())),
            light_need: level(own.light_need.into()),
            propagation_points: own.propagation_points as usize,
            reach: reach_steps as i64,
            reach2: square_steps(reach_steps),
            room: Disc::new(room_steps),
            keeps_away: species.iter().enumerate().filter_map(keeps_away).collect(),
            stays_away: species.iter().map(stays_away).collect(),
            shade: Disc::new(2.0 * room_steps),
            shades: shades.into_iter().filter(|&(_, taken)| taken > 0.0).collect(),
            room_steps: room_steps as f32,
        }
    }

    /// Surplus of the scarcest nutrient over its needs (Liebig's law of the minimum); `None` if a need is not met.
    pub(super) fn surplus(&self, soil: [u16; 3]) -> Option<u16> {
        let surplus = |nutrient: usize| soil[nutrient].checked_sub(self.needs[nutrient]);
        Some(surplus(0)?.min(surplus(1)?).min(surplus(2)?))
    }

    /// Vigour of a plant that got `got` from this many sites.
    pub(super) fn vigour(&self, got: [u64; 3], sites: u64) -> u8 {
        let fraction = |nutrient: usize| (got[nutrient] * 255).checked_div(u64::from(self.uptake[nutrient]) * sites);
        (0..3).filter_map(fraction).min().unwrap_or(255) as u8
    }
}
