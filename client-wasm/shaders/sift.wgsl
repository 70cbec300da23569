// Which plants of the grids about the camera stand in view: what follows is done for them alone. Far from all that may stand do, so that plants near the eye can
// be as many as there are.

@group(1) @binding(8) var<storage, read_write> sifted: array<atomic<u32>>;
// Workgroups of the near plants and of the others, each for an indirect dispatch.
@group(1) @binding(9) var<storage, read_write> sifted_groups: array<atomic<u32>, 6>;
// Height of the land at the place of each near plant (m), as `ground_of` has it.
@group(1) @binding(10) var<storage, read_write> grounds: array<f32>;

// More than tufts draw a plant aside from its place (m).
const TUFT_M: f32 = 0.5;

// Instead of the height of the land where no plant has room (m).
const NO_ROOM: f32 = -1e9;

// Height of the land at a plant's place (m), if it has room there.
fn ground_of(grid: vec2<i32>, index: u32) -> f32 {
    let place = plant_place(grid, index);
    let has_room = random3(grid, index + 31u).x <= grass_share(place) * 1.02 - 0.02;
    return select(NO_ROOM, ground_height(place), has_room);
}

// Whether a plant of a grid may be seen, whose land is so high.
fn may_stand(grid: vec2<i32>, index: u32, height: f32) -> bool {
    let place = plant_place(grid, index);
    let ground = vec3<f32>(place.x, height, place.y);
    let is_grown = growth(index, max(distance(ground, frame.eye.xyz) - TUFT_M, 0.0)) > 0.01;
    return (height > NO_ROOM) & is_grown & ((plants.counts.y == 0u) | is_seen(ground, plants.reach.x));
}

// The next number of a list, for whose every 64 a workgroup follows.
fn next(list: u32) -> u32 {
    let number = atomicAdd(&sifted[list], 1u);
    if number % 64u == 0u {
        atomicAdd(&sifted_groups[3u * list], 1u);
    }
    return number;
}

// Finds the land below the plants of near grids that have moved in in this frame.
@compute @workgroup_size(64)
fn find_ground(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = plants.slots[id.y];
    if id.x < plants.counts.x && u32(slot.z) == plants.counts.w {
        grounds[id.y * plants.counts.x + id.x] = ground_of(slot.xy, id.x);
    }
}

@compute @workgroup_size(64)
fn sift_near(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = plants.slots[id.y];
    let at = id.y * plants.counts.x + id.x;
    if i32(id.x) < slot.w && may_stand(slot.xy, id.x, grounds[at]) {
        atomicStore(&sifted[LISTED + next(0u)], at);
    }
}

@compute @workgroup_size(64)
fn sift_far(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let chunk = chunks[group.x];
    let index = u32(chunk.z) + local;
    if index < u32(chunk.w) && may_stand(chunk.xy, index, ground_of(chunk.xy, index)) {
        atomicStore(&sifted[LISTED + 9u * plants.counts.x + next(1u)], group.x * 64u + local);
    }
}
