// Plants of grass grids: where they are, and how far they have grown at a distance.

import package::constants::{LEAST_DENSITY_DISTANCE_M, UNIT_STEPS};
import package::inputs::frame::frame;
import package::inputs::random::random3;
import package::plants::backbone::WIDER;
import package::plants::chunk::Chunk;
import package::uniforms::Plants;

@group(1) @binding(0) var<uniform> plants: Plants;
@group(1) @binding(4) var<storage, read> chunks: array<Chunk>;

// Start of the list of near plants.
const LISTED: u32 = 2u;

// Approximate radius of a flower head (m).
const HEAD_RADIUS_M: f32 = 0.04;
// Greatest width of a blade relative to `frame.blade_width_m`, by kind and chance.
const WIDEST: f32 = 1.95;

// Bound on how far a plant at a distance reaches beyond its height by the width of its blade and by its flower head, both of which grow where plants
// thin out (m).
fn widest_m(distance_m: f32, full_density_m: f32, heads_thin_m: f32, thinnest_px: f32) -> f32 {
    let thinnest_m = distance_m * frame.pixel_rad * thinnest_px;
    let width_m = max(frame.blade_width_m * WIDEST * max(distance_m / full_density_m, 1.0), thinnest_m);
    // A square with a textured flower reaches twice its radius.
    let head_m = 2.0 * max(HEAD_RADIUS_M * max(distance_m / heads_thin_m, 1.0), thinnest_m);
    return 0.5 * WIDER * width_m + head_m;
}

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
