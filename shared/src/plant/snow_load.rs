//! Snow on plants: it weighs them down, and slows their sway.
//!
//! Leaves intercept snow until they bear no more (Hedstrom and Pomeroy 1998): a mass M of snow per area of ground leaves
//! `L·LAI·(1 − exp(−M/(L·LAI)))` on leaves of area index LAI, each of which bears at most L per leaf area. A blade droops by its own weight in proportion to
//! that weight, and its frequency falls with the root of its mass. Where snow has been pressed, plants have shed it.

use crate::scene::Snow;

/// Mass of fresh leaves of grass per leaf area (kg/m²): a dry mass of 0.05 kg/m², at a dry fraction of a quarter (Poorter et al. 2009).
pub const LEAF_KG_M2: f32 = 0.2;

/// Mass of undisturbed snow that rests on leaves, relative to their own.
pub fn relative_load(snow: &Snow, leaf_area_index: f32) -> f32 {
    let most_kg_m2 = snow.leaf_load_kg_m2 * leaf_area_index;
    if most_kg_m2 <= 0.0 || !snow.lies() {
        return 0.0;
    }
    let held_kg_m2 = most_kg_m2 * (1.0 - libm::expf(-snow.mass_kg_m2() / most_kg_m2));
    held_kg_m2 / (leaf_area_index * LEAF_KG_M2)
}

/// Snow on leaves as a fraction of the most that they bear.
pub fn load_share(snow: &Snow, leaf_area_index: f32) -> f32 {
    if snow.leaf_load_kg_m2 > 0.0 { relative_load(snow, leaf_area_index) * LEAF_KG_M2 / snow.leaf_load_kg_m2 } else { 0.0 }
}

/// Mass of a plant with its snow, relative to its own, where the depth of the snow differs by `difference_m` from that of undisturbed snow. Twin of
/// `laden_mass` in client-wasm/shaders/land_and_sky/snow.wgsl.
pub fn laden_mass(relative_load: f32, depth_m: f32, difference_m: f32) -> f32 {
    1.0 + relative_load * (1.0 + difference_m / depth_m.max(1e-3)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leaves_bear_all_of_a_dusting_and_at_most_their_load() {
        let load = |depth_m| relative_load(&Snow { depth_m, ..Snow::default() }, 2.0);
        // 0.2 mm at 120 kg/m³ on leaves of 0.4 kg/m².
        assert!((load(0.0002) - 0.024 / 0.4).abs() < 0.002, "{}", load(0.0002));
        assert!((load(0.5) - 0.3 / LEAF_KG_M2).abs() < 1e-5);
        assert!((load_share(&Snow { depth_m: 0.5, ..Snow::default() }, 2.0) - 1.0).abs() < 1e-5);
        assert_eq!((load(0.0), relative_load(&Snow { depth_m: 0.1, ..Snow::default() }, 0.0)), (0.0, 0.0));
    }

    #[test]
    fn plants_in_a_rut_have_shed_their_snow() {
        let mass = |difference_m| laden_mass(1.5, 0.2, difference_m);
        assert_eq!([0.0, 0.1, -0.2, -0.3].map(mass), [2.5, 2.5, 1.0, 1.0]);
        assert!((mass(-0.1) - 1.75).abs() < 1e-6);
    }
}
