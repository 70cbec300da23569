//! The underbrush that objects and the wind break, for good (004 §3.2).
//!
//! - Objects: a component that is pressed to lean by θ is bent over its lower half: the moment at its foot is then 2·θ·EI/L. What a moving object passes over
//!   must lie below it: a plant of height H under a body that is c above the land leans by arccos(c/H), or by as much as the grass there if that is more. It
//!   breaks when 2·θ exceeds the strength of any component that it stands on, and falls the way that it is pressed. The wash of a helicopter breaks nothing so.
//! - Wind: a plant breaks when the air at half its height presses harder than its species [bears](shared::plant::underbrush::bearing::bears_pa), and falls
//!   downwind. Each is looked at every two seconds; none while the wind is too weak anywhere for the weakest species.

mod broken;
mod gale;

pub use broken::BrokenPlants;

use crate::bend::Meadow;
use crate::bend::contact::{STANDING_M_PER_S, length};
use crate::weather::Weather;
use gale::Gale;
use shared::plant::flora::{Flora, height_m};
use shared::plant::underbrush::bearing::bears_rad;
use shared::wire::BrokenPlant;
use shared::wire::quantise::heading_code;

/// The plants of a world, and which of them are broken.
pub struct Plants {
    flora: Option<Flora>,
    species: Vec<Bearing>,
    /// Height of the tallest plants (m).
    tallest_m: f32,
    gale: Gale,
    fallen: Fallen,
}

/// What the plants of a species bear.
#[derive(Clone, Copy)]
struct Bearing {
    height_m: f32,
    /// Bend beyond which they break (rad).
    bears_rad: f32,
}

/// What is broken.
struct Fallen {
    /// Whether the plant of each site is.
    is_broken: Vec<bool>,
    all: BrokenPlants,
}

impl Fallen {
    fn is_broken(&self, site: u32) -> bool {
        self.is_broken[site as usize]
    }

    /// Breaks a whole plant, which falls along a vector on the ground.
    fn fell(&mut self, site: u32, along: [f32; 2]) {
        self.is_broken[site as usize] = true;
        self.all.push(BrokenPlant { site, fall: heading_code(along) });
    }
}

impl Plants {
    /// Whole plants in a world that goes by steps of `dt_secs`.
    pub fn new(flora: Option<Flora>, dt_secs: f32) -> Self {
        let known = || flora.iter().flat_map(|flora| flora.species().iter().zip(flora.plans()));
        let sites = flora.as_ref().map_or(0, |flora| flora.grown().sites.total());
        Self {
            species: known().map(|(species, plan)| Bearing { height_m: height_m(species), bears_rad: bears_rad(plan) }).collect(),
            tallest_m: known().map(|(species, _)| height_m(species) * (1.0 + species.size_variation)).fold(0.0, f32::max),
            gale: Gale::new(flora.as_ref(), dt_secs),
            fallen: Fallen { is_broken: vec![false; sites], all: BrokenPlants::default() },
            flora,
        }
    }

    /// What grows; none where nothing does.
    pub fn flora(&self) -> Option<&Flora> {
        self.flora.as_ref()
    }

    /// The broken plants, in one step those that objects broke before those that the wind did, in the order of the objects and of the sites.
    pub fn broken(&self) -> &BrokenPlants {
        &self.fallen.all
    }

    /// Breaks what the newest step pressed too far. Costs something only where an object moves over the grass, and in a storm.
    pub fn step(&mut self, tick: u64, dt_secs: f32, meadow: &Meadow, weather: &Weather) {
        let Some(flora) = &self.flora else { return };
        let grown = flora.grown();
        let passages = meadow.passages(self.tallest_m).filter(|(swath, _)| swath.way_m() > STANDING_M_PER_S * dt_secs);
        for (swath, clearance_m) in passages {
            for leg in swath.legs() {
                let [low_m, high_m] = leg.cover().bounds_m();
                for plant in grown.in_rectangle(low_m, high_m) {
                    let at_m = grown.sites.place_m(plant.site);
                    let Some(passage) = leg.passage(at_m).filter(|_| !self.fallen.is_broken(plant.site)) else { continue };
                    let Bearing { height_m, bears_rad } = self.species[usize::from(plant.species)];
                    let below_rad = (clearance_m / (height_m * flora.standing(plant).size)).min(1.0).acos();
                    let lean_rad = meadow.lean_rad(at_m, weather.ground());
                    if below_rad.max(length(lean_rad)) > bears_rad {
                        let along = if length(lean_rad) > below_rad { lean_rad } else { passage.moves_m };
                        self.fallen.fell(plant.site, along);
                    }
                }
            }
        }
        let strongest_m_per_s = weather.strongest_m_per_s(self.gale.reach_m());
        self.gale.blow(tick, flora, strongest_m_per_s, |at_m| weather.wind_m_per_s(at_m), &mut self.fallen);
    }
}
