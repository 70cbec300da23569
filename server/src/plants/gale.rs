//! Plants that the wind breaks.

use super::Fallen;
use crate::bend::contact::length;
use shared::plant::flora::{Flora, Standing, height_m};
use shared::plant::force_field::{AIR_KG_PER_M3, dynamic_pressure_pa};
use shared::plant::underbrush::bearing::bears_pa;
use shared::wind::share_near_ground;

/// Time in which every plant is looked at once (s).
const ROUND_SECS: f32 = 2.0;

/// What the plants of each species bear, and how often they are looked at.
pub(super) struct Gale {
    round_ticks: u64,
    species: Vec<Bearing>,
    reach_m: f32,
    /// Wind of the lowest 2 m in which the first plant may break (m/s).
    least_m_per_s: f32,
}

struct Bearing {
    /// Pressure of the air that it bears at half its height (Pa).
    pressure_pa: f32,
    height_m: f32,
}

impl Gale {
    pub(super) fn new(flora: Option<&Flora>, dt_secs: f32) -> Self {
        let mut gale = Self {
            round_ticks: (ROUND_SECS / dt_secs).round().max(1.0) as u64,
            species: vec![],
            reach_m: 0.0,
            least_m_per_s: f32::INFINITY,
        };
        for (species, plan) in flora.into_iter().flat_map(|flora| flora.species().iter().zip(flora.plans())) {
            let bearing = Bearing { pressure_pa: bears_pa(plan), height_m: height_m(species) };
            if bearing.pressure_pa.is_finite() {
                let tallest_m = 0.5 * bearing.height_m * (1.0 + species.size_variation);
                let free_m_per_s = (2.0 * bearing.pressure_pa / AIR_KG_PER_M3).sqrt();
                gale.reach_m = gale.reach_m.max(tallest_m);
                gale.least_m_per_s = gale.least_m_per_s.min(free_m_per_s / share_near_ground(tallest_m));
            }
            gale.species.push(bearing);
        }
        gale
    }

    /// Half the height of the tallest plants that break at all (m).
    pub(super) fn reach_m(&self) -> f32 {
        self.reach_m
    }

    /// Breaks what the wind presses too hard among the plants whose turn it is: in each step some from all over the land. The wind is told by the place (X,
    /// height above the ground, Z; m); up to [`reach_m`](Self::reach_m) it is at most `strongest_m_per_s`.
    pub(super) fn blow(
        &self,
        tick: u64,
        flora: &Flora,
        strongest_m_per_s: f32,
        wind_m_per_s: impl Fn([f32; 3]) -> [f32; 3],
        fallen: &mut Fallen,
    ) {
        if strongest_m_per_s <= self.least_m_per_s {
            return;
        }
        let (first, step) = ((tick % self.round_ticks) as usize, self.round_ticks as usize);
        for plant in flora.grown().plants().iter().skip(first).step_by(step) {
            let bearing = &self.species[usize::from(plant.species)];
            if bearing.pressure_pa.is_infinite() || fallen.is_broken(plant.site) {
                continue;
            }
            let Standing { at_m: [x, z], size, .. } = flora.standing(plant);
            let above_m = 0.5 * bearing.height_m * size;
            let [east_pa, _, south_pa] = dynamic_pressure_pa(wind_m_per_s([x, above_m, z]));
            if length([east_pa, south_pa]) > bearing.pressure_pa {
                fallen.fell(plant.site, [east_pa, south_pa]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::BrokenPlants;
    use super::*;
    use shared::scene::parse_underbrush;
    use shared::terrain::{CoverMap, grey_png};
    use shared::wire::quantise::heading_code;
    use std::cell::Cell;

    /// Reeds and ferns all over 64 m × 64 m.
    fn flora() -> Flora {
        let mut scene = crate::scenes::load("underbrush").expect("a built-in scene is sound").scene;
        scene.patches.count = [4; 2];
        let species = parse_underbrush(include_str!("../../scenes/species.toml")).expect("sound species").into_iter();
        scene.underbrush = species.filter(|species| ["reed", "fern"].contains(&species.name.as_str())).collect();
        for species in &mut scene.underbrush {
            (species.cover, species.needs, species.uptake, species.light_need, species.propagation_points) =
                (0, [0.0; 3], [0.0; 3], 0.0, 100);
        }
        let cover = CoverMap::from_png(&grey_png([2; 2], &[255; 4])).expect("a grey PNG");
        Flora::new(&scene, &cover, None).expect("a scene with underbrush")
    }

    /// What a wind of so many m/s along X and Z at 2 m breaks in a round, and how many plants were looked at.
    fn broken(flora: &Flora, [east, south]: [f32; 2]) -> (BrokenPlants, usize) {
        let gale = Gale::new(Some(flora), 1.0 / 60.0);
        let mut fallen = Fallen { is_broken: vec![false; flora.grown().sites.total()], all: BrokenPlants::default() };
        let looks = Cell::new(0);
        let wind = |[_, above_m, _]: [f32; 3]| {
            looks.set(looks.get() + 1);
            [east, 0.0, south].map(|speed| speed * share_near_ground(above_m))
        };
        (1000..1000 + gale.round_ticks).for_each(|tick| gale.blow(tick, flora, length([east, south]), wind, &mut fallen));
        (fallen.all, looks.get())
    }

    #[test]
    fn a_storm_breaks_the_taller_reeds_and_a_hurricane_all_of_them_but_no_fern() {
        let flora = flora();
        let reeds: Vec<_> = flora.grown().plants().iter().filter(|plant| plant.species == 0).collect();
        assert!(reeds.len() > 300 && reeds.len() + 300 < flora.grown().plants().len());
        let (bears_pa, height_m) = (bears_pa(&flora.plans()[0]), height_m(&flora.species()[0]));
        for wind_m_per_s in [20.0_f32, 22.0, 23.0, 30.0] {
            let pressure_pa = |above_m: f32| 0.6 * wind_m_per_s * wind_m_per_s * (0.5 * above_m).sqrt();
            let breaks = |plant: &&&shared::plant::growth::Plant| pressure_pa(0.5 * height_m * flora.standing(plant).size) > bears_pa;
            let mut wanted: Vec<u32> = reeds.iter().filter(breaks).map(|plant| plant.site).collect();
            let (found, _) = broken(&flora, [0.6 * wind_m_per_s, -0.8 * wind_m_per_s]);
            let mut sites: Vec<u32> = found.iter().map(|plant| plant.site).collect();
            assert!(found.iter().all(|plant| plant.fall == heading_code([0.6, -0.8])), "downwind");
            sites.sort_unstable();
            wanted.sort_unstable();
            assert_eq!(sites, wanted, "at {wind_m_per_s} m/s");
            let share = sites.len() as f32 / reeds.len() as f32;
            assert!(if wind_m_per_s < 21.0 {
                share == 0.0
            } else if wind_m_per_s > 29.0 {
                share == 1.0
            } else {
                (0.01..0.99).contains(&share)
            });
        }
    }

    #[test]
    fn nobody_is_looked_at_in_a_wind_that_breaks_none() {
        let flora = flora();
        let least_m_per_s = Gale::new(Some(&flora), 1.0 / 60.0).least_m_per_s;
        assert!((21.0..22.5).contains(&least_m_per_s), "the tallest reeds break at {least_m_per_s} m/s");
        assert_eq!(broken(&flora, [0.999 * least_m_per_s, 0.0]).1, 0);
        let reeds = flora.grown().plants().iter().filter(|plant| plant.species == 0).count();
        assert_eq!(broken(&flora, [1.001 * least_m_per_s, 0.0]).1, reeds, "each of those that can break once in a round");
        assert_eq!(Gale::new(None, 1.0 / 60.0).least_m_per_s, f32::INFINITY);
    }
}
