//! Uniforms of the kinds of grass.

use crate::render::gpu::uniforms::{KIND_LIMIT, Kind, Kinds};
use bytemuck::Zeroable;
use prairie_core::scene::{Grass, Plants, Scene};
use std::f32::consts::TAU;

/// The kinds of a scene; the first is `[grass]`.
pub(crate) fn table(scene: &Scene) -> Kinds {
    let mut list = [Kind::zeroed(); KIND_LIMIT];
    let kinds = scene.kinds().into_iter().zip(scene.kinds_of_plants());
    for (entry, (grass, plants)) in list.iter_mut().zip(kinds) {
        *entry = kind(scene, &grass, &plants);
    }
    Kinds { list }
}

fn kind(scene: &Scene, grass: &Grass, plants: &Plants) -> Kind {
    let usual = scene.grass.waves.stiffness_per_s2;
    let stiffness = if usual > 0.0 { grass.waves.stiffness_per_s2 / usual } else { 1.0 };
    let droop = stiffness.powf(-0.25).clamp(0.5, 1.6);
    let width = (plants.height_m / scene.plants.height_m).sqrt().clamp(0.8, 1.5);
    Kind {
        root_rgb: plants.root_rgb,
        height_m: plants.height_m,
        tip_rgb: plants.tip_rgb,
        wind_bend_rad: grass.wind_bend_rad,
        bend_m_per_s: grass.waves.c0_m_per_s,
        bend_m_per_rad: grass.waves.mu_m_per_rad,
        lag_secs: grass.lag_secs,
        rising_lag: grass.recovery_lag_share,
        segments: grass.segments as f32,
        frequency_rad_per_s: TAU * plants.swing_hz,
        droop,
        width,
    }
}
