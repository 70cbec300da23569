//! Spread of species over the sites, outward from their propagation points (Endo et al. 2003, §5.2).
//!
//! Painted areas come first: there a species comes up wherever it has room, whatever the soil and the light. Then each species draws its propagation
//! points at random from the sites that suit it, and the species take turns: each places one plant, on the richest site that it has reached.
//! A plant that comes up
//! - takes up nutrients: from the soil of each site nearer than its room, including its own, `uptake` of each nutrient or what is left;
//! - closes the sites that are too near to other species;
//! - shades shorter species: a plant of height H and room r takes the fraction `shade · 2·(1 − h/H) · (2 − d/r)` of daylight from one of height h at
//!   the distance d. That is `shade` for half the height at the distance of its room, and falls linearly to zero at twice the room. Shades add up;
//! - scatters [`SEEDS`] seeds evenly over the square about it; those within its reach make sites candidates.
//!
//! The candidates of a species wait in a priority queue, ordered by the surplus of the scarcest nutrient over the need, at random between equals. As
//! soil only gets poorer, a candidate drained by others since it was queued is detected at its turn and queued again with its present surplus; so the
//! one that is taken is always the richest at present.

use super::habit::Habit;
use super::sites::STEPS;
use super::{Grown, Lot, Plant, Sites, Soil};
use crate::hash::hash3;
use crate::scene::Underbrush;
use crate::terrain::Cover;
use std::collections::BinaryHeap;

/// Number of seeds that a plant scatters.
pub const SEEDS: u32 = 32;

/// Largest number of species that grow together.
pub const SPECIES_LIMIT: usize = 16;

/// Permission to grow at a position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Permission {
    /// Nothing grows: bare ground, a tree, a stone, or outside the world.
    Closed,
    /// Any species may grow.
    Open,
    /// Only the species of this index may grow.
    Painted(u8),
}

impl Permission {
    /// The permission where the covering map says `cover`.
    pub fn new(cover: Cover, is_grass: bool, species: &[Underbrush]) -> Self {
        let painted = match cover {
            Cover::Free(id) => species.iter().position(|species| species.cover == id),
            _ => None,
        };
        match painted {
            Some(index) => Self::Painted(index as u8),
            None if is_grass => Self::Open,
            None => Self::Closed,
        }
    }
}

/// Grows `species` of these heights (m) on `soil`. `shade` is that of [`Growth`](crate::scene::Growth); `ground` gives the permission at a position
/// (m, X and Z), [`Closed`](Permission::Closed) outside the world.
///
/// Takes 5 bytes a site while it runs, 2 more for each species that others shade, and 8 for each waiting candidate.
///
/// # Panics
/// When there are more than [`SPECIES_LIMIT`] species, not one height for each, or not one soil for each site; or when `ground` names an unknown
/// species.
pub fn grow(
    sites: Sites,
    soil: Soil,
    species: &[Underbrush],
    heights_m: &[f32],
    shade: f32,
    ground: impl Fn([f32; 2]) -> Permission,
) -> Grown {
    assert!(species.len() <= SPECIES_LIMIT && species.len() == heights_m.len() && soil.levels().len() == sites.total());
    let habits = Habit::of_all(species, heights_m, shade, &sites);
    let mut lattice = Lattice::new(sites, soil, &habits);
    let painted = lattice.lay_out(ground, habits.len());
    let mut queues = vec![BinaryHeap::new(); habits.len()];
    for ((species, habit), places) in habits.iter().enumerate().zip(painted) {
        for site in lattice.draw(places.into_iter(), species, usize::MAX) {
            if lattice.is_open(site, species) && lattice.has_room(site, habit) {
                lattice.come_up(site, species, habit, &mut queues[species]);
            }
        }
    }
    for (species, habit) in habits.iter().enumerate() {
        let suited = (0..lattice.sites.total())
            .filter(|&site| lattice.is_open(site, species) && habit.surplus(lattice.soil.levels()[site]).is_some());
        let points = lattice.draw(suited, species, habit.propagation_points);
        points.into_iter().for_each(|site| lattice.reach(site, species, habit, &mut queues[species]));
    }
    let mut is_growing = true;
    while is_growing {
        is_growing = false;
        for (species, habit) in habits.iter().enumerate() {
            is_growing |= lattice.take_turn(species, habit, &mut queues[species]);
        }
    }
    Grown::new(lattice.sites, lattice.soil, lattice.taken, lattice.plants)
}

/// A site that a species has reached, ordered by its surplus of nutrients (16 bits), then a random number (24 bits), then its number (24 bits).
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Candidate(u64);

impl Candidate {
    fn new(surplus: u16, lot: u32, site: usize) -> Self {
        Self(u64::from(surplus) << 48 | u64::from(lot >> 8) << 24 | site as u64)
    }

    fn site(self) -> usize {
        self.0 as usize & 0xff_ffff
    }

    fn surplus(self) -> u16 {
        (self.0 >> 48) as u16
    }

    /// The same candidate with a smaller surplus.
    fn with_surplus(self, surplus: u16) -> Self {
        Self(self.0 & 0xffff_ffff_ffff | u64::from(surplus) << 48)
    }
}

/// Priority queue of candidates, the richest first.
type Queue = BinaryHeap<Candidate>;

/// State of the sites while species spread over them.
struct Lattice {
    sites: Sites,
    soil: Soil,
    taken: [u64; 3],
    plants: Vec<Plant>,
    /// Bits of the species to which each site is closed.
    closed: Vec<u16>,
    /// Bits of the species that have reached each site.
    reached: Vec<u16>,
    /// Index of the species at each site, plus 1; 0 for none.
    standing: Vec<u8>,
    /// Remaining light at each site for each species; empty for species that are never shaded.
    light: Vec<Vec<u16>>,
}

impl Lattice {
    fn new(sites: Sites, soil: Soil, habits: &[Habit]) -> Self {
        let total = sites.total();
        let is_shaded = |species: usize| habits.iter().any(|habit| habit.shades.iter().any(|&(other, _)| other == species));
        let light = (0..habits.len()).map(|species| if is_shaded(species) { vec![u16::MAX; total] } else { vec![] }).collect();
        Self {
            sites,
            soil,
            taken: [0; 3],
            plants: vec![],
            closed: vec![0; total],
            reached: vec![0; total],
            standing: vec![0; total],
            light,
        }
    }

    /// Closes sites to species that the ground excludes. Returns the sites painted with each species.
    fn lay_out(&mut self, ground: impl Fn([f32; 2]) -> Permission, species: usize) -> Vec<Vec<usize>> {
        let mut painted = vec![vec![]; species];
        for site in 0..self.sites.total() {
            match ground(self.sites.place_m(site as u32)) {
                Permission::Open => {}
                Permission::Closed => self.closed[site] = u16::MAX,
                Permission::Painted(index) => {
                    self.closed[site] = !(1 << index);
                    self.reached[site] = 1 << index;
                    painted[usize::from(index)].push(site);
                }
            }
        }
        painted
    }

    /// Random number of a site for a species.
    fn lot(&self, site: usize, species: usize) -> u32 {
        hash3([site as u32, species as u32, Lot::Point.seed(self.sites.seed())])[0]
    }

    /// Draws `count` of these sites at random for a species, or all if there are fewer.
    fn draw(&self, sites: impl Iterator<Item = usize>, species: usize, count: usize) -> Vec<usize> {
        let mut lots: Vec<_> = sites.map(|site| (self.lot(site, species), site as u32)).collect();
        if count < lots.len() {
            lots.select_nth_unstable(count);
            lots.truncate(count);
        }
        lots.sort_unstable();
        lots.into_iter().map(|(_, site)| site as usize).collect()
    }

    fn is_open(&self, site: usize, species: usize) -> bool {
        self.closed[site] & 1 << species == 0
    }

    /// Makes a site a candidate of a species, once, if it may come up there.
    fn reach(&mut self, site: usize, species: usize, habit: &Habit, queue: &mut Queue) {
        let bit = 1 << species;
        if (self.closed[site] | self.reached[site]) & bit == 0 {
            self.reached[site] |= bit;
            if let Some(surplus) = habit.surplus(self.soil.levels()[site]) {
                queue.push(Candidate::new(surplus, self.lot(site, species), site));
            }
        }
    }

    /// Places the next plant of a species. Returns whether there was room for one.
    fn take_turn(&mut self, species: usize, habit: &Habit, queue: &mut Queue) -> bool {
        while let Some(candidate) = queue.pop() {
            let site = candidate.site();
            let Some(surplus) = habit.surplus(self.soil.levels()[site]).filter(|_| self.is_open(site, species)) else { continue };
            if surplus < candidate.surplus() {
                queue.push(candidate.with_surplus(surplus));
                continue;
            }
            let is_light = self.light[species].get(site).is_none_or(|&light| light >= habit.light_need);
            if is_light && self.has_room(site, habit) {
                self.come_up(site, species, habit, queue);
                return true;
            }
        }
        false
    }

    /// Whether no plant of a species with less room is too near; those with more room have closed the site.
    fn has_room(&self, site: usize, habit: &Habit) -> bool {
        let is_too_near = |(other, distance2): (usize, i64)| match self.standing[other] {
            0 => false,
            standing => distance2 < habit.stays_away[usize::from(standing) - 1],
        };
        !self.sites.within(&habit.room, site).any(is_too_near)
    }

    fn come_up(&mut self, site: usize, species: usize, habit: &Habit, queue: &mut Queue) {
        self.standing[site] = species as u8 + 1;
        let vigour = self.settle(site, habit);
        self.plants.push(Plant { site: site as u32, species: species as u8, vigour });
        self.shade(site, habit);
        self.scatter(site, species, habit, queue);
    }

    /// Takes up nutrients and closes sites. Returns the plant's vigour.
    fn settle(&mut self, site: usize, habit: &Habit) -> u8 {
        let (mut got, mut count) = ([0; 3], 0);
        let soil = self.soil.levels_mut();
        self.sites.within(&habit.room, site).for_each(|(other, distance2)| {
            for nutrient in 0..3 {
                let taken = soil[other][nutrient].min(habit.uptake[nutrient]);
                soil[other][nutrient] -= taken;
                got[nutrient] += u64::from(taken);
            }
            count += 1;
            for &(bit, apart2) in &habit.keeps_away {
                self.closed[other] |= if distance2 < apart2 { bit } else { 0 };
            }
        });
        self.taken = std::array::from_fn(|nutrient| self.taken[nutrient] + got[nutrient]);
        habit.vigour(got, count)
    }

    fn shade(&mut self, site: usize, habit: &Habit) {
        if habit.shades.is_empty() {
            return;
        }
        self.sites.within(&habit.shade, site).for_each(|(other, distance2)| {
            let fall = 2.0 - (distance2 as f32).sqrt() / habit.room_steps;
            for &(species, taken) in &habit.shades {
                let light = &mut self.light[species][other];
                // The cast saturates: a shade beyond full daylight takes all of it.
                *light = light.saturating_sub((taken * fall) as u16);
            }
        });
    }

    fn scatter(&mut self, site: usize, species: usize, habit: &Habit, queue: &mut Queue) {
        let [x, z] = self.sites.point(site);
        let seed = Lot::Seed.seed(self.sites.seed());
        let fall = |bits: u32| ((i64::from(bits) * (2 * habit.reach + 1)) >> 32) - habit.reach;
        for number in 0..SEEDS {
            let [east, south, _] = hash3([site as u32, species as u32 * SEEDS + number, seed]);
            let square = [x + fall(east), z + fall(south)].map(|steps| steps.div_euclid(STEPS));
            if let Some(other) = self.sites.site(square).filter(|&other| self.sites.distance2(site, other) < habit.reach2) {
                self.reach(other, species, habit, queue);
            }
        }
    }
}
