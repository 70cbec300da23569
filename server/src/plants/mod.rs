//! The underbrush that objects and the wind break, for good (004 §3.2).
//!
//! - Objects: a component that is pressed to lean by θ is bent over its lower half: the moment at its foot is then 2·θ·EI/L. So a plant breaks when an object
//!   that moves passes over its site, the grass there is bent by θ, and 2·θ exceeds the strength of any component that it stands on. It falls the way that
//!   the grass there leans. The wash of a helicopter breaks nothing so.
//! - Wind: a plant breaks when the air at half its height presses harder than its species [bears](shared::plant::underbrush::bearing::bears_pa), and falls
//!   downwind. Each is looked at every two seconds; none while the wind is too weak anywhere for the weakest species.

mod broken;
mod gale;

pub use broken::BrokenPlants;

use crate::bend::Meadow;
use crate::bend::contact::{STANDING_M_PER_S, length};
use crate::weather::Weather;
use gale::Gale;
use shared::plant::flora::Flora;
use shared::plant::underbrush::bearing::bears_rad;
use shared::wire::BrokenPlant;
use shared::wire::quantise::heading_code;

/// The plants of a world, and which of them are broken.
pub struct Plants {
    flora: Option<Flora>,
    /// Bend beyond which each species breaks (rad).
    bears_rad: Vec<f32>,
    gale: Gale,
    fallen: Fallen,
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
        let sites = flora.as_ref().map_or(0, |flora| flora.grown().sites.total());
        Self {
            bears_rad: flora.iter().flat_map(|flora| flora.plans()).map(bears_rad).collect(),
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
        let moving = meadow.contacts().iter().filter(|contact| contact.swath.way_m() > STANDING_M_PER_S * dt_secs);
        for leg in moving.flat_map(|contact| contact.swath.legs()) {
            let [low_m, high_m] = leg.cover().bounds_m();
            for plant in grown.in_rectangle(low_m, high_m) {
                let at_m = grown.sites.place_m(plant.site);
                if self.fallen.is_broken(plant.site) || leg.passage(at_m).is_none() {
                    continue;
                }
                let lean_rad = meadow.lean_rad(at_m, weather.ground());
                if length(lean_rad) > self.bears_rad[usize::from(plant.species)] {
                    self.fallen.fell(plant.site, lean_rad);
                }
            }
        }
        let strongest_m_per_s = weather.strongest_m_per_s(self.gale.reach_m());
        self.gale.blow(tick, flora, strongest_m_per_s, |at_m| weather.wind_m_per_s(at_m), &mut self.fallen);
    }
}
