//! Storm damage: breaking of plants by wind.

use super::broken_state::BrokenState;
use prairie_core::grass::vector::length;
use prairie_core::plant::flora::{Flora, PlantInstance, height_m};
use prairie_core::plant::force_field::{AIR_KG_PER_M3, dynamic_pressure_pa};
use prairie_core::plant::underbrush::bearing::bears_pa;
use prairie_core::wind::near_ground_fraction;

/// Interval at which each plant is checked (s).
const INTERVAL_SECS: f32 = 2.0;

/// Wind limits of each species, and the interval of the checks.
pub(super) struct StormDamage {
    interval_ticks: u64,
    species: Vec<WindLimit>,
    reach_m: f32,
    /// Wind in the lowest 2 m at which the first plant may break (m/s).
    least_m_per_s: f32,
}

struct WindLimit {
    /// Dynamic pressure at half its height at which it breaks (Pa).
    pressure_pa: f32,
    height_m: f32,
}

impl StormDamage {
    pub(super) fn new(flora: Option<&Flora>, dt_secs: f32) -> Self {
        let mut damage = Self {
            interval_ticks: (INTERVAL_SECS / dt_secs).round().max(1.0) as u64,
            species: vec![],
            reach_m: 0.0,
            least_m_per_s: f32::INFINITY,
        };
        for (species, plan) in flora.into_iter().flat_map(|flora| flora.species().iter().zip(flora.plans())) {
            let limit = WindLimit { pressure_pa: bears_pa(plan), height_m: height_m(species) };
            if limit.pressure_pa.is_finite() {
                let tallest_m = 0.5 * limit.height_m * (1.0 + species.size_variation);
                let free_m_per_s = (2.0 * limit.pressure_pa / AIR_KG_PER_M3).sqrt();
                damage.reach_m = damage.reach_m.max(tallest_m);
                damage.least_m_per_s = damage.least_m_per_s.min(free_m_per_s / near_ground_fraction(tallest_m));
            }
            damage.species.push(limit);
        }
        damage
    }

    /// Half the height of the tallest plants that can break (m).
    pub(super) fn reach_m(&self) -> f32 {
        self.reach_m
    }

    /// Checks the plants that are due in this step, a fraction from all over the terrain, and breaks those above their wind limit. `wind_m_per_s` is a
    /// function of X, height above the ground, and Z (m); up to [`reach_m`](Self::reach_m) its result is at most `strongest_m_per_s`.
    pub(super) fn step(
        &self,
        tick: u64,
        flora: &Flora,
        strongest_m_per_s: f32,
        wind_m_per_s: impl Fn([f32; 3]) -> [f32; 3],
        broken: &mut BrokenState,
    ) {
        if strongest_m_per_s <= self.least_m_per_s {
            return;
        }
        let (first, step) = ((tick % self.interval_ticks) as usize, self.interval_ticks as usize);
        for plant in flora.grown().plants().iter().skip(first).step_by(step) {
            let limit = &self.species[usize::from(plant.species)];
            if limit.pressure_pa.is_infinite() || broken.is_broken(plant.site) {
                continue;
            }
            let PlantInstance { at_m: [x, z], size, .. } = flora.instance(plant);
            let above_m = 0.5 * limit.height_m * size;
            let [east_pa, _, south_pa] = dynamic_pressure_pa(wind_m_per_s([x, above_m, z]));
            if length([east_pa, south_pa]) > limit.pressure_pa {
                broken.break_plant(plant.site, [east_pa, south_pa]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::snapshot::BrokenPlants;
    use prairie_core::scene::parse_underbrush;
    use prairie_core::terrain::{CoverMap, grey_png};
    use prairie_core::wire::quantise::heading_code;
    use std::cell::Cell;

    /// Reeds and ferns all over 64 m × 64 m.
    fn flora() -> Flora {
        let mut scene = crate::scenes::load("underbrush").expect("a built-in scene is sound").scene;
        scene.patches.count = [4; 2];
        scene.underbrush = parse_underbrush(include_str!("../../../tests/scenes/plants/reed-and-fern.toml")).expect("valid species");
        for species in &mut scene.underbrush {
            (species.cover, species.needs, species.uptake, species.light_need, species.propagation_points) =
                (0, [0.0; 3], [0.0; 3], 0.0, 100);
        }
        let cover = CoverMap::from_png(&grey_png([2; 2], &[255; 4])).expect("a grey PNG");
        Flora::new(&scene, &cover, None).expect("a scene with underbrush")
    }

    /// Plants broken by a wind (m/s, along X and Z at 2 m) in one interval, and the number of plants checked.
    fn broken(flora: &Flora, [east, south]: [f32; 2]) -> (BrokenPlants, usize) {
        let damage = StormDamage::new(Some(flora), 1.0 / 60.0);
        let mut broken = BrokenState::new(flora.grown().sites.total());
        let checks = Cell::new(0);
        let wind = |[_, above_m, _]: [f32; 3]| {
            checks.set(checks.get() + 1);
            [east, 0.0, south].map(|speed| speed * near_ground_fraction(above_m))
        };
        (1000..1000 + damage.interval_ticks).for_each(|tick| damage.step(tick, flora, length([east, south]), wind, &mut broken));
        (broken.plants().clone(), checks.get())
    }

    #[test]
    fn a_storm_breaks_the_taller_reeds_and_a_hurricane_all_of_them_but_no_fern() {
        let flora = flora();
        let reeds: Vec<_> = flora.grown().plants().iter().filter(|plant| plant.species == 0).collect();
        assert!(reeds.len() > 300 && reeds.len() + 300 < flora.grown().plants().len());
        let (bears_pa, height_m) = (bears_pa(&flora.plans()[0]), height_m(&flora.species()[0]));
        for wind_m_per_s in [20.0_f32, 22.0, 23.0, 30.0] {
            let pressure_pa = |above_m: f32| 0.6 * wind_m_per_s * wind_m_per_s * (0.5 * above_m).sqrt();
            let breaks = |plant: &&&prairie_core::plant::growth::Plant| pressure_pa(0.5 * height_m * flora.instance(plant).size) > bears_pa;
            let mut wanted: Vec<u32> = reeds.iter().filter(breaks).map(|plant| plant.site).collect();
            let (found, _) = broken(&flora, [0.6 * wind_m_per_s, -0.8 * wind_m_per_s]);
            let mut sites: Vec<u32> = found.iter().map(|plant| plant.site).collect();
            assert!(found.iter().all(|plant| plant.fall == heading_code([0.6, -0.8])), "downwind");
            sites.sort_unstable();
            wanted.sort_unstable();
            assert_eq!(sites, wanted, "at {wind_m_per_s} m/s");
            let fraction = sites.len() as f32 / reeds.len() as f32;
            assert!(if wind_m_per_s < 21.0 {
                fraction == 0.0
            } else if wind_m_per_s > 29.0 {
                fraction == 1.0
            } else {
                (0.01..0.99).contains(&fraction)
            });
        }
    }

    #[test]
    fn no_plant_is_checked_in_a_wind_that_breaks_none() {
        let flora = flora();
        let least_m_per_s = StormDamage::new(Some(&flora), 1.0 / 60.0).least_m_per_s;
        assert!((21.0..22.5).contains(&least_m_per_s), "the tallest reeds break at {least_m_per_s} m/s");
        assert_eq!(broken(&flora, [0.999 * least_m_per_s, 0.0]).1, 0);
        let reeds = flora.grown().plants().iter().filter(|plant| plant.species == 0).count();
        assert_eq!(broken(&flora, [1.001 * least_m_per_s, 0.0]).1, reeds, "each plant that can break is checked once in an interval");
        assert_eq!(StormDamage::new(None, 1.0 / 60.0).least_m_per_s, f32::INFINITY);
    }
}
