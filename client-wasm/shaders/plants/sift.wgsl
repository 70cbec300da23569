// Compaction: lists the plants around the camera that may be in view, so that the following passes run for them alone. Buffers for near
// plants can be large, since few of them are in view at once.

import package::constants::{CHUNK, NEAR_SLOTS, TUFT_REACH_M};
import package::inputs::depth_pyramid::is_sphere_hidden;
import package::inputs::frame::frame;
import package::inputs::frustum::is_seen;
import package::inputs::random::random3;
import package::land_and_sky::ground::{grass_fraction, ground_height};
import package::plants::grid_plants::{chunks, growth, LISTED, plant_place, plants, widest_m};

@group(1) @binding(8) var<storage, read_write> sifted: array<atomic<u32>>;
// Workgroups of near plants and of others, as arguments of indirect dispatches.
@group(1) @binding(9) var<storage, read_write> sifted_groups: array<atomic<u32>, 6>;
// Height of the land at each near plant (m), from `ground_of`.
@group(1) @binding(10) var<storage, read_write> grounds: array<f32>;

// Height in place of the land's where no plant stands (m).
const NO_PLANT_M: f32 = -1e9;

// Height of the land at a plant (m), or `NO_PLANT_M`.
fn ground_of(grid: vec2<i32>, index: u32) -> f32 {
    let place = plant_place(grid, index);
    let has_room = random3(grid, index + 31u).x <= grass_fraction(place) * 1.02 - 0.02;
    return select(NO_PLANT_M, ground_height(place), has_room);
}

// Whether a plant on land of that height may be in view.
fn may_stand(grid: vec2<i32>, index: u32, height: f32) -> bool {
    let place = plant_place(grid, index);
    let ground = vec3<f32>(place.x, height, place.y);
    let distance_m = distance(ground, frame.eye_m);
    let is_grown = growth(index, max(distance_m - TUFT_REACH_M, 0.0)) > 0.01;
    if !((height > NO_PLANT_M) & is_grown & ((plants.culls == 0u) | is_seen(ground, plants.plant_reach_m))) {
        return false;
    }
    let reach_m = plants.plant_reach_m + widest_m(distance_m + TUFT_REACH_M, plants.full_density_m, plants.heads_thin_m, plants.thinnest_px);
    return !is_sphere_hidden(ground, reach_m);
}

// Reserves the next index of a list; every full chunk of entries adds a workgroup.
fn next(list: u32) -> u32 {
    let number = atomicAdd(&sifted[list], 1u);
    if number % CHUNK == 0u {
        atomicAdd(&sifted_groups[3u * list], 1u);
    }
    return number;
}

// Finds the land below the plants of grids that became near in this frame.
@compute @workgroup_size(CHUNK)
fn find_ground(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = plants.slots[id.y];
    if id.x < plants.grid_plants && slot.moved_in == plants.frame_number {
        grounds[id.y * plants.grid_plants + id.x] = ground_of(slot.grid, id.x);
    }
}

@compute @workgroup_size(CHUNK)
fn sift_near(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = plants.slots[id.y];
    let at = id.y * plants.grid_plants + id.x;
    if id.x < slot.plants && may_stand(slot.grid, id.x, grounds[at]) {
        atomicStore(&sifted[LISTED + next(0u)], at);
    }
}

@compute @workgroup_size(CHUNK)
fn sift_far(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let chunk = chunks[group.x];
    let index = chunk.first + local;
    if index < chunk.grid_plants && may_stand(chunk.grid, index, ground_of(chunk.grid, index)) {
        atomicStore(&sifted[LISTED + NEAR_SLOTS * plants.grid_plants + next(1u)], group.x * CHUNK + local);
    }
}
