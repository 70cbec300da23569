// Plants of grass grids: where they are, and how far they have grown at a distance.

import package::constants::{LEAST_DENSITY_DISTANCE_M, UNIT_STEPS};
import package::inputs::frame::frame;
import package::inputs::random::random3;
import package::plants::chunk::Chunk;
import package::uniforms::Plants;

@group(1) @binding(0) var<uniform> plants: Plants;
@group(1) @binding(4) var<storage, read> chunks: array<Chunk>;

// Start of the list of near plants.
const LISTED: u32 = 2u;

// Position of plant `index` of a grid: a low-discrepancy sequence, so that any prefix of it covers the grid evenly.
fn plant_place(grid: vec2<i32>, index: u32) -> vec2<f32> {
    let start = random3(grid, 0u).xy;
    let jitter = random3(grid, index + 101u).xy - 0.5;
    let along = vec2<u32>(index * 3242174889u, index * 2447445414u);
    let fraction = fract(start + vec2<f32>(along >> vec2<u32>(8u)) / UNIT_STEPS);
    return (vec2<f32>(grid) + fraction) * plants.grid_m + jitter * 0.12;
}

// Growth factor of a plant where the density falls, and where the last plants end: 0 gone, 1 full size, as for all plants nearer than nine
// tenths of the distance of full density.
fn growth(index: u32, distance_m: f32) -> f32 {
    let near = plants.full_density_m / max(distance_m, LEAST_DENSITY_DISTANCE_M);
    let places = f32(plants.grid_plants);
    let kept = places * near * near;
    let thinning = clamp((kept - f32(index)) / (0.18 * min(kept, places)), 0.0, 1.0);
    let staying = 1.0 - plants.shrinks * smoothstep(frame.blades_fade_from_m, frame.blades_end_m, distance_m);
    return select(thinning * staying, 0.0, distance_m >= frame.blades_end_m);
}
