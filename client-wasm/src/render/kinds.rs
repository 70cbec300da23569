//! The kinds of grass as the shaders know them.

use super::uniforms::{KIND_LIMIT, Kind, Kinds};
use bytemuck::Zeroable;
use shared::scene::{Grass, Plants, Scene};
use std::f32::consts::TAU;

/// The table of a scene's kinds, that of `[grass]` first.
pub(super) fn table(scene: &Scene) -> Kinds {
    let mut list = [Kind::zeroed(); KIND_LIMIT];
    let kinds = scene.kinds().into_iter().zip(scene.kinds_of_plants());
    for (place, (grass, plants)) in list.iter_mut().zip(kinds) {
        *place = kind(scene, &grass, &plants);
    }
    Kinds { list }
}

fn kind(scene: &Scene, grass: &Grass, plants: &Plants) -> Kind {
    let [root, tip] = [plants.root_rgb, plants.tip_rgb];
    let usual = scene.grass.stiffness_per_s2;
    let stiffness = if usual > 0.0 { grass.stiffness_per_s2 / usual } else { 1.0 };
    let droop = stiffness.powf(-0.25).clamp(0.5, 1.6);
    let width = (plants.height_m / scene.plants.height_m).sqrt().clamp(0.8, 1.5);
    Kind {
        root: [root[0], root[1], root[2], plants.height_m],
        tip: [tip[0], tip[1], tip[2], grass.wind_bend_rad],
        lag: [grass.c0_m_per_s, grass.mu_m_per_rad, grass.lag_secs, grass.recovery_lag_share],
        shape: [grass.segments as f32, TAU * plants.swing_hz, droop, width],
    }
}
