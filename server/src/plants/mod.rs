//! Permanent damage of the underbrush by objects and wind (Endo et al. 2003, §3.2).
//!
//! - Objects: a component that is pressed to lean by θ is bent over its lower half, so the moment at its foot is 2·θ·EI/L. A plant below a moving object must
//!   fit under it: a plant of height H under a body at clearance c leans by arccos(c/H), or as much as the grass there if that is more. It breaks when 2·θ
//!   exceeds the strength of any of its components on the ground, and falls in the direction of the lean. A helicopter's downwash breaks no plant in this way.
//! - Wind: a plant breaks when the dynamic pressure at half its height exceeds the
//!   [breaking pressure](prairie_core::plant::underbrush::bearing::bears_pa) of its species, and falls downwind. Each plant is checked every two seconds,
//!   and none while the wind is everywhere too weak for the weakest species.

mod broken_state;
mod storm_damage;

use crate::checksum::Checksum;
use crate::snapshot::BrokenPlants;
use crate::weather::Weather;
use broken_state::BrokenState;
use prairie_core::grass::BendSimulation;
use prairie_core::grass::contact::STANDSTILL_M_PER_S;
use prairie_core::grass::vector::length;
use prairie_core::plant::flora::{Flora, height_m};
use prairie_core::plant::underbrush::bearing::bears_rad;
use storm_damage::StormDamage;

/// The underbrush of a world and its damage.
pub struct PlantDamage {
    flora: Option<Flora>,
    species: Vec<BendLimit>,
    /// Height of the tallest plants (m).
    tallest_m: f32,
    storm: StormDamage,
    broken: BrokenState,
}

/// Height and strength of a species.
#[derive(Clone, Copy, Debug)]
struct BendLimit {
    height_m: f32,
    /// Bend above which its plants break (rad).
    bears_rad: f32,
}

impl PlantDamage {
    /// Intact plants, in a world with steps of `dt_secs`.
    pub fn new(flora: Option<Flora>, dt_secs: f32) -> Self {
        let known = || flora.iter().flat_map(|flora| flora.species().iter().zip(flora.plans()));
        let sites = flora.as_ref().map_or(0, |flora| flora.grown().sites.total());
        Self {
            species: known().map(|(species, plan)| BendLimit { height_m: height_m(species), bears_rad: bears_rad(plan) }).collect(),
            tallest_m: known().map(|(species, _)| height_m(species) * (1.0 + species.size_variation)).fold(0.0, f32::max),
            storm: StormDamage::new(flora.as_ref(), dt_secs),
            broken: BrokenState::new(sites),
            flora,
        }
    }

    /// The underbrush, if the scene has any.
    pub fn flora(&self) -> Option<&Flora> {
        self.flora.as_ref()
    }

    /// Broken plants, oldest first. Within a step those broken by objects come first, in the order of the objects; then those broken by wind, in the order of
    /// the sites.
    pub fn broken(&self) -> &BrokenPlants {
        self.broken.plants()
    }

    /// Restores a list of broken plants; false if it is that of another scene.
    pub fn restore(&mut self, broken: BrokenPlants) -> bool {
        self.broken.restore(broken)
    }

    /// Breaks plants overloaded in the newest step. Takes time only where an object moves over the grass, and in a storm.
    pub fn step(&mut self, tick: u64, dt_secs: f32, bend: &BendSimulation, weather: &Weather) {
        let Some(flora) = &self.flora else { return };
        let grown = flora.grown();
        let moving = bend.swept_below(self.tallest_m).filter(|(swept, _)| swept.travel_m() > STANDSTILL_M_PER_S * dt_secs);
        for (swept, clearance_m) in moving {
            for leg in swept.legs() {
                let [low_m, high_m] = leg.cover().bounds_m();
                for plant in grown.in_rectangle(low_m, high_m) {
                    let at_m = grown.sites.place_m(plant.site);
                    let Some(passage) = leg.passage(at_m).filter(|_| !self.broken.is_broken(plant.site)) else { continue };
                    let BendLimit { height_m, bears_rad } = self.species[usize::from(plant.species)];
                    let below_rad = (clearance_m / (height_m * flora.instance(plant).size)).min(1.0).acos();
                    let lean_rad = bend.lean_rad(at_m, weather.field());
                    if below_rad.max(length(lean_rad)) > bears_rad {
                        let along = if length(lean_rad) > below_rad { lean_rad } else { passage.moves_m };
                        self.broken.break_plant(plant.site, along);
                    }
                }
            }
        }
        let strongest_m_per_s = weather.field().strongest_m_per_s(self.storm.reach_m());
        self.storm.step(tick, flora, strongest_m_per_s, |at_m| weather.field().wind_at(at_m), &mut self.broken);
    }

    /// Adds the broken plants to a checksum.
    pub(crate) fn hash(&self, sum: &mut Checksum) {
        sum.add(self.broken().iter().flat_map(|plant| [plant.site, plant.fall.get().into()]));
    }
}
