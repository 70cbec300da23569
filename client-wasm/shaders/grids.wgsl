// Which grass grids about the camera are seen, and how many of their plants: 64 of them are a workgroup of the passes that follow.

struct Squares {
    // First grid of the square about the camera (x, z); grids along its side; 1 to leave out what is not seen.
    window: vec4<i32>,
    // Plants of a grid near the camera; most chunks of single plants; grids on each side of the camera's that are simulated; unused.
    counts: vec4<u32>,
    // Grids of the square that are listed: the first, and the first that is not; unused.
    turn: vec4<u32>,
    // Side of a grid (m), distance of full density (m), distance at which single plants end (m), how far plants reach beyond their grid (m).
    shape: vec4<f32>,
    // Size of a cell of the lowest land (m, X and Z); unused.
    cells: vec4<f32>,
}

// Up to 64 plants of a grid: its place (x, z), the first of them, and how many the grid has.
struct Chunk {
    place: vec4<i32>,
}

struct Workgroups {
    count: atomic<u32>,
    y: u32,
    z: u32,
}

@group(1) @binding(0) var<uniform> squares: Squares;
@group(1) @binding(1) var<storage, read_write> chunks: array<Chunk>;
@group(1) @binding(2) var<storage, read_write> workgroups: Workgroups;

@group(1) @binding(3) var lowest: texture_2d<f32>;

// Steps of a look along the land, and how much lower the land may be drawn than it is (m, and per metre of distance): its tiles get coarser there.
const LOOKS: u32 = 24u;
const DRAWN_LOWER_M: f32 = 0.3;
const DRAWN_LOWER: f32 = 0.004;

// What the far hills beyond the world's edge may differ from a few samples of them (m).
const HILLS_SLACK_M: f32 = 4.0;

// Lowest and highest land of a rectangle (m).
fn heights_within(low: vec2<f32>, high: vec2<f32>) -> vec2<f32> {
    let last = vec2<i32>(frame.maps.xy) - 1;
    let start = clamp(vec2<i32>(floor(low / frame.world.zw)), vec2<i32>(0), last);
    let end = clamp(vec2<i32>(ceil(high / frame.world.zw)), vec2<i32>(0), last);
    var range = vec2<f32>(1e9, -1e9);
    for (var z = start.y; z <= end.y; z++) {
        for (var x = start.x; x <= end.x; x++) {
            let height = textureLoad(heights, vec2<i32>(x, z), 0).r;
            range = vec2<f32>(min(range.x, height), max(range.y, height));
        }
    }
    if any(low < vec2<f32>(0.0)) || any(high > frame.world.xy) {
        for (var i = 0u; i < 9u; i++) {
            let height = ground_height(mix(low, high, vec2<f32>(f32(i % 3u), f32(i / 3u)) * 0.5));
            range = vec2<f32>(min(range.x, height - HILLS_SLACK_M), max(range.y, height + HILLS_SLACK_M));
        }
    }
    return range;
}

// Lowest land of a rectangle (m), at most; far below everything beyond the world's edge.
fn lowest_within(low: vec2<f32>, high: vec2<f32>) -> f32 {
    if any(low < vec2<f32>(0.0)) || any(high >= frame.world.xy) {
        return -1e9;
    }
    let start = vec2<i32>(low / squares.cells.xy);
    let end = vec2<i32>(high / squares.cells.xy);
    var found = 1e9;
    for (var z = start.y; z <= end.y; z++) {
        for (var x = start.x; x <= end.x; x++) {
            found = min(found, textureLoad(lowest, vec2<i32>(x, z), 0).r);
        }
    }
    return found;
}

// Whether the land surely hides a box from the eye: a share of the way along, all rays to it pass one rectangle, no higher than the ray to its top does.
fn is_hidden(low: vec3<f32>, high: vec3<f32>) -> bool {
    let eye = frame.eye.xyz;
    // An eye under the land sees through it.
    if eye.y < ground_height(eye.xz + none_of(low.x)) + DRAWN_LOWER_M {
        return false;
    }
    let far = length(max(abs(low.xz - eye.xz), abs(high.xz - eye.xz)));
    for (var i = 1u; i < LOOKS; i++) {
        let share = f32(i) / f32(LOOKS);
        let ground = lowest_within(mix(eye.xz, low.xz, share), mix(eye.xz, high.xz, share));
        if ground - DRAWN_LOWER_M - DRAWN_LOWER * far * share > mix(eye.y, high.y, share) {
            return true;
        }
    }
    return false;
}

@compute @workgroup_size(64)
fn list_grids(@builtin(global_invocation_id) id: vec3<u32>) {
    let side = u32(squares.window.z);
    if id.x >= side * side || id.x < squares.turn.x || id.x >= squares.turn.y {
        return;
    }
    let offset = vec2<i32>(i32(id.x % side), i32(id.x / side));
    let away = abs(offset - i32(side / 2u));
    if max(away.x, away.y) <= i32(squares.counts.z) {
        return;
    }
    let grid = squares.window.xy + offset;
    let reach = squares.shape.w;
    let low = vec2<f32>(grid) * squares.shape.x;
    let high = low + squares.shape.x;
    let range = heights_within(low - reach, high + reach);
    let box_low = vec3<f32>(low.x - reach, range.x - reach, low.y - reach);
    let box_high = vec3<f32>(high.x + reach, range.y + reach, high.y + reach);
    let nearest = clamp(frame.eye.xyz, vec3<f32>(low.x, range.x, low.y), vec3<f32>(high.x, range.y, high.y));
    let distance_m = distance(nearest, frame.eye.xyz);
    if distance_m >= squares.shape.z {
        return;
    }
    let is_unseen = !is_box_seen(box_low, box_high) || is_hidden(box_low, box_high);
    if is_unseen & (squares.window.w != 0) {
        return;
    }
    let count = u32(ceil(f32(squares.counts.x) * density(distance_m, squares.shape.y)));
    let needed = (count + 63u) / 64u;
    let first = atomicAdd(&workgroups.count, needed);
    for (var i = 0u; i < needed; i++) {
        if first + i < squares.counts.y {
            chunks[first + i] = Chunk(vec4<i32>(grid, i32(i * 64u), i32(count)));
        }
    }
}
