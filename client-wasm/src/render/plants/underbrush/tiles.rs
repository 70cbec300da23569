//! Grid squares of underbrush plants, each culled as a unit.

use super::bake::VARIANTS;
use crate::render::gpu::constants::{ENLARGEMENT_EXPONENT, MIN_KEPT_FRACTION};
use crate::state::DecodedScene;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use prairie_core::plant::flora::{self, Flora};

/// Side of a square (m).
const TILE_M: f32 = 8.0;

/// A plant of `underbrush.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct UnderbrushPlant {
    pub(crate) at_m: [f32; 2],
    size: f32,
    pub(super) species_and_variant: u32,
    heading_rad: f32,
    pub(crate) site: u32,
}

/// Plants of a square of the land.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlantTile {
    pub(super) row: i32,
    pub(super) low_m: Vec3,
    pub(super) high_m: Vec3,
    pub(super) first: u32,
    pub(super) count: u32,
}

/// Number of a square along an axis.
pub(super) fn tile_number(m: f32) -> i32 {
    (m / TILE_M).floor() as i32
}

/// All plants sorted by square, and the squares sorted by row.
pub(crate) fn tiles(decoded: &DecodedScene, flora: &Flora) -> (Vec<UnderbrushPlant>, Vec<PlantTile>) {
    let reaches_m: Vec<f32> = flora.species().iter().map(flora::reach_m).collect();
    let mut by_tile: Vec<([i32; 2], UnderbrushPlant, f32)> = flora
        .grown()
        .plants()
        .iter()
        .map(|plant| {
            let instance = flora.instance(plant);
            let species_and_variant = instance.species as u32 | (instance.number % VARIANTS) << 8;
            let grown = UnderbrushPlant {
                at_m: instance.at_m,
                size: instance.size,
                species_and_variant,
                heading_rad: instance.heading_rad,
                site: plant.site,
            };
            (
                instance.at_m.map(tile_number),
                grown,
                reaches_m[instance.species] * instance.size * MIN_KEPT_FRACTION.powf(ENLARGEMENT_EXPONENT),
            )
        })
        .collect();
    by_tile.sort_by_key(|&([x, z], ..)| [z, x]);
    let mut tiles = Vec::new();
    let mut first = 0;
    for own in by_tile.chunk_by(|a, b| a.0 == b.0) {
        let (mut low_m, mut high_m) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for (_, plant, reach_m) in own {
            let [x, z] = plant.at_m;
            let ground_m = decoded.heights().height_m(x, z);
            low_m = low_m.min(Vec3::new(x - reach_m, ground_m - 0.1, z - reach_m));
            high_m = high_m.max(Vec3::new(x + reach_m, ground_m + reach_m, z + reach_m));
        }
        tiles.push(PlantTile { row: own[0].0[1], low_m, high_m, first, count: own.len() as u32 });
        first += own.len() as u32;
    }
    (by_tile.into_iter().map(|(_, plant, _)| plant).collect(), tiles)
}
