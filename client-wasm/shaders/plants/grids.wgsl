// Culls grass grids around the camera and lists their plants in chunks, each one workgroup of the following passes.

import package::constants::{CHUNK, DRAWN_LOWER, DRAWN_LOWER_M, GRID_BEYOND, GRID_HIDDEN, GRID_OUTSIDE, GRID_SHOWN, HORIZON_SAMPLES};
import package::inputs::depth_pyramid::is_box_hidden;
import package::inputs::frame::{frame, runtime_zero};
import package::inputs::frustum::is_box_seen;
import package::land_and_sky::ground::{ground_height, heights};
import package::land_and_sky::sward::density;
import package::plants::chunk::Chunk;
import package::plants::grid_plants::widest_m;
import package::uniforms::Squares;

struct Workgroups {
    count: atomic<u32>,
    y: u32,
    z: u32,
}

@group(1) @binding(0) var<uniform> squares: Squares;
@group(1) @binding(1) var<storage, read_write> chunks: array<Chunk>;
@group(1) @binding(2) var<storage, read_write> workgroups: Workgroups;

@group(1) @binding(3) var lowest: texture_2d<f32>;
// State of each grid of the square, for the map of the grids.
@group(1) @binding(4) var<storage, read_write> states: array<u32>;

// Maximum difference of the hills beyond the edge of the world from a few samples of them (m).
const HILLS_SLACK_M: f32 = 4.0;

// Minimum and maximum height of the land in a rectangle (m).
fn heights_within(low: vec2<f32>, high: vec2<f32>) -> vec2<f32> {
    let last = vec2<i32>(frame.heights_px) - 1;
    let start = clamp(vec2<i32>(floor(low / frame.height_spacing_m)), vec2<i32>(0), last);
    let end = clamp(vec2<i32>(ceil(high / frame.height_spacing_m)), vec2<i32>(0), last);
    var range = vec2<f32>(1e9, -1e9);
    for (var z = start.y; z <= end.y; z++) {
        for (var x = start.x; x <= end.x; x++) {
            let height = textureLoad(heights, vec2<i32>(x, z), 0).r;
            range = vec2<f32>(min(range.x, height), max(range.y, height));
        }
    }
    if any(low < vec2<f32>(0.0)) || any(high > frame.world_extent_m) {
        for (var i = 0u; i < 9u; i++) {
            let height = ground_height(mix(low, high, vec2<f32>(f32(i % 3u), f32(i / 3u)) * 0.5));
            range = vec2<f32>(min(range.x, height - HILLS_SLACK_M), max(range.y, height + HILLS_SLACK_M));
        }
    }
    return range;
}

// Lower bound of the height of the land in a rectangle (m); −1e9 beyond the edge of the world.
fn lowest_within(low: vec2<f32>, high: vec2<f32>) -> f32 {
    if any(low < vec2<f32>(0.0)) || any(high >= frame.world_extent_m) {
        return -1e9;
    }
    let start = vec2<i32>(low / squares.lowest_cell_m);
    let end = vec2<i32>(high / squares.lowest_cell_m);
    var found = 1e9;
    for (var z = start.y; z <= end.y; z++) {
        for (var x = start.x; x <= end.x; x++) {
            found = min(found, textureLoad(lowest, vec2<i32>(x, z), 0).r);
        }
    }
    return found;
}

// Conservative horizon test: true if the land hides a box from the eye. At some fraction of the distance, all rays to the box cross one
// rectangle, whose lowest ground is above the ray to the top of the box. Twin of `hides` in lowest_land.rs.
fn is_hidden(low: vec3<f32>, high: vec3<f32>) -> bool {
    let eye = frame.eye_m;
    // An eye below the ground sees through it.
    if eye.y < ground_height(eye.xz + runtime_zero(low.x)) + DRAWN_LOWER_M {
        return false;
    }
    let far = length(max(abs(low.xz - eye.xz), abs(high.xz - eye.xz)));
    for (var i = 1u; i < HORIZON_SAMPLES; i++) {
        let fraction = f32(i) / f32(HORIZON_SAMPLES);
        let ground = lowest_within(mix(eye.xz, low.xz, fraction), mix(eye.xz, high.xz, fraction));
        if ground - DRAWN_LOWER_M - DRAWN_LOWER * far * fraction > mix(eye.y, high.y, fraction) {
            return true;
        }
    }
    return false;
}

// Whether solids hide a box (m) of plants whose nearest is at a distance.
fn is_box_behind_solids(low: vec3<f32>, high: vec3<f32>, distance_m: f32) -> bool {
    let farthest_m = distance_m + distance(low, high);
    let wider_m = widest_m(farthest_m, squares.full_density_m, squares.heads_thin_m, squares.thinnest_px);
    return is_box_hidden(low - wider_m, high + wider_m);
}

@compute @workgroup_size(CHUNK)
fn list_grids(@builtin(global_invocation_id) id: vec3<u32>) {
    let side = u32(squares.side);
    if id.x >= side * side || id.x < squares.first || id.x >= squares.end {
        return;
    }
    let offset = vec2<i32>(i32(id.x % side), i32(id.x / side));
    let away = abs(offset - i32(side / 2u));
    if max(away.x, away.y) <= i32(squares.near_grids) {
        return;
    }
    let grid = squares.first_grid + offset;
    let reach = squares.plant_reach_m;
    let low = vec2<f32>(grid) * squares.grid_m;
    let high = low + squares.grid_m;
    let range = heights_within(low - reach, high + reach);
    let box_low = vec3<f32>(low.x - reach, range.x - reach, low.y - reach);
    let box_high = vec3<f32>(high.x + reach, range.y + reach, high.y + reach);
    let nearest = clamp(frame.eye_m, vec3<f32>(low.x, range.x, low.y), vec3<f32>(high.x, range.y, high.y));
    let distance_m = distance(nearest, frame.eye_m);
    if distance_m >= squares.reach_m {
        states[id.x] = GRID_BEYOND;
        return;
    }
    var state = GRID_SHOWN;
    if !is_box_seen(box_low, box_high) {
        state = GRID_OUTSIDE;
    } else if is_hidden(box_low, box_high) || is_box_behind_solids(box_low, box_high, distance_m) {
        state = GRID_HIDDEN;
    }
    if (state != GRID_SHOWN) & (squares.culls != 0) {
        states[id.x] = state;
        return;
    }
    states[id.x] = GRID_SHOWN;
    let count = u32(ceil(f32(squares.grid_plants) * density(distance_m, squares.full_density_m)));
    let needed = (count + CHUNK - 1u) / CHUNK;
    let first = atomicAdd(&workgroups.count, needed);
    for (var i = 0u; i < needed; i++) {
        if first + i < squares.chunk_limit {
            chunks[first + i] = Chunk(grid, i * CHUNK, count);
        }
    }
}
