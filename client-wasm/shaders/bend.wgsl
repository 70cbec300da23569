// Single plants: how each blade and flower stem that `sift.wgsl` has listed stands in this frame, and which of them are seen.
//
// Near plants (nine grids about the camera) keep the sway of their links from frame to frame and obey drag and stiffness (000
// section 3.2, `blade.wgsl`); those farther away stand as the bend field and the wind of the moment would have them.

struct Plants {
    // Grid (x, z) that lives in each of the nine slots; number of the frame in which it has moved in; plants of it that may stand.
    slots: array<vec4<i32>, 9>,
    // Plants of a near grid; 1 to leave out what is not seen; 1 where blades narrower than a pixel are drawn as wide as they are; number of the
    // frame, of those in which time passes or a grid moves in.
    counts: vec4<u32>,
    // Capacities of the lists: fine blades, all others, flower heads; unused.
    capacities: vec4<u32>,
    // Side of a grid (m), distance of full density (m), distance up to which blades are fine (m), damping share of a blade.
    shape: vec4<f32>,
    // Steps of this frame; way of integration; segments of a fine blade, and of a coarse one.
    steps: vec4<u32>,
    // Length of a step (s); lot of the first plant of a grid to be a flower, and the power with which that falls; least width that a blade is
    // drawn with (px): 0 in the reference alone, where heads are no discs either.
    time: vec4<f32>,
    // Most that a plant reaches beyond its place (m); distance from which on heads thin out, and those left are larger (m); 1 where plants shrink away towards
    // where the last ones end, 0 where they fade into what stands for far plants; unused.
    reach: vec4<f32>,
}

struct Counters {
    drawn: array<atomic<u32>, 5>,
}

@group(1) @binding(0) var<uniform> plants: Plants;
@group(1) @binding(1) var<storage, read_write> sways: array<Sway>;
@group(1) @binding(2) var<storage, read_write> drawn: array<Blade>;
@group(1) @binding(3) var<storage, read_write> counters: Counters;
// Up to 64 plants each: grid (x, z), the first, and how many the grid has.
@group(1) @binding(4) var<storage, read> chunks: array<vec4<i32>>;
@group(1) @binding(5) var<storage, read_write> draws: array<u32>;
// How many near plants are listed, and how many others; their places in `sways`; the others' chunks · 64 + places there.
@group(1) @binding(6) var<storage, read> standing: array<u32>;
// Number of the frame that has moved a near plant last, of those that are counted.
@group(1) @binding(7) var<storage, read_write> moved: array<u32>;

// Where the list of the near plants begins.
const LISTED: u32 = 2u;

const FINE: u32 = 0u;
const COARSE: u32 = 1u;
const SINGLE: u32 = 2u;
const HEAD: u32 = 3u;
const FAR_HEAD: u32 = 4u;

// About the radius of a flower's head (m).
const HEAD_RADIUS_M: f32 = 0.04;
// Radius in the picture below which one is drawn as a disc (px).
const FAR_HEAD_PX: f32 = 4.0;

// Height in the picture below which a blade is one segment (px).
const SINGLE_PX: f32 = 12.0;
// Share by which that, and the distance up to which a blade is fine, differ from one to another, up or down; twin of the constant in `blades/mod.rs`.
const FINE_SPREAD: f32 = 0.15;

// How high petals stand over the blade in whose place they are, and how much that varies (000 section 3.3).
const PETALS_SHARE: f32 = 0.65;
const PETALS_SPREAD: f32 = 0.05;
// How much of a blade's lean a flower shows in the same wind: it is heavier, and slower by the root of it (000 section 3.4).
const FLOWER_GIVE: f32 = 0.55;

struct Plant {
    root: vec3<f32>,
    // Length (m).
    height: f32,
    // Lowest natural frequency (rad/s).
    frequency: f32,
    width: f32,
    // Direction in which it leans by itself, as a vector of its lean (rad).
    droop: vec2<f32>,
    side: f32,
    hue: f32,
    is_flower: bool,
    kind: u32,
    normal: vec3<f32>,
}

// Place of plant `index` of a grid: a low-discrepancy sequence, so that any first part of it covers the grid evenly.
fn plant_place(grid: vec2<i32>, index: u32) -> vec2<f32> {
    let start = random3(grid, 0u).xy;
    let jitter = random3(grid, index + 101u).xy - 0.5;
    let along = vec2<u32>(index * 3242174889u, index * 2447445414u);
    let share = fract(start + vec2<f32>(along >> vec2<u32>(8u)) / 16777216.0);
    return (vec2<f32>(grid) + share) * plants.shape.x + jitter * 0.12;
}

// Flowers stand where a lot says so; the lot falls along the sequence, so that they thin out more slowly than blades.
fn is_flower(grid: vec2<i32>, index: u32, first_lot: f32, power: f32) -> bool {
    return random3(grid, index + 22051u).x < first_lot * pow(f32(index) + 1.0, power);
}

fn is_flower_at(grid: vec2<i32>, index: u32) -> bool {
    return is_flower(grid, index, plants.time.y, plants.time.z);
}

// Kind of a flower, of six, as a share; in drifts, where three of four are of one kind.
fn flower_at(grid: vec2<i32>, index: u32, place: vec2<f32>) -> f32 {
    let lot = random3(grid, index + 61u).yz;
    let drift = floor(6.0 * fract(5.0 * noise(place / 37.0).b));
    return select(lot.y, (drift + lot.y) / 6.0, lot.x < 0.75);
}

fn plant_at(grid: vec2<i32>, index: u32, place: vec2<f32>, is_flower: bool) -> Plant {
    let r = random3(grid, index + 7919u);
    let s = random3(grid, index + 15013u);
    // Tufts: plants draw together and share height, colour and lean.
    let tuft = vec2<i32>(floor(place / 0.42));
    let shared_by = random3(tuft, 3u);
    let centre = (vec2<f32>(tuft) + 0.25 + 0.5 * random3(tuft, 5u).xy) * 0.42;
    let p = mix(place, centre, 0.34 * r.x);
    let away = p - centre;
    var plant: Plant;
    plant.root = vec3<f32>(p.x, ground_height(p), p.y);
    plant.normal = ground_normal(p);
    // Kinds mingle where they meet.
    plant.kind = kind_at(p + (r.xz - 0.5) * 0.7);
    let kind = kinds.list[plant.kind];
    let grown = fed(p) * mix(0.78, 1.15, shared_by.x);
    plant.height = kind.root.w * (1.0 + frame.blade.y * (2.0 * r.y - 1.0)) * grown;
    plant.frequency = kind.shape.y * kind.root.w / plant.height;
    plant.width = frame.blade.z * kind.shape.w * mix(0.75, 1.3, r.z);
    let own = (s.x - 0.5) * TAU;
    let leaning = away * 2.2 + (shared_by.yz - 0.5) * 0.5 + vec2<f32>(cos(own), sin(own)) * mix(0.08, 0.42, s.y * s.y);
    plant.droop = leaning * kind.shape.z;
    plant.side = own + s.z * 1.3;
    plant.hue = clamp(shared_by.y * 0.45 + s.z * 0.55, 0.0, 0.999);
    plant.is_flower = is_flower;
    if is_flower {
        plant.height *= PETALS_SHARE + PETALS_SPREAD * (2.0 * random3(grid, index + 22051u).y - 1.0);
        plant.frequency *= sqrt(FLOWER_GIVE);
        plant.width = frame.blade.z * kind.shape.w * 0.45;
        plant.droop = leaning * 0.35;
    }
    return plant;
}

// Leans of a plant whose thirds are pressed by `leans_in` (rad) and that droops of itself: each third leans more than the one
// below, but for plants of one segment.
fn leans_of(plant: Plant, leans_in: array<vec2<f32>, 3>) -> array<vec2<f32>, 3> {
    var pressed = leans_in;
    var shares = WIND_SHAPE;
    var leans: array<vec2<f32>, 3>;
    let is_stiff = kinds.list[plant.kind].shape.x < 1.5;
    let flat_share = smoothstep(0.5, 1.3, length(pressed[0]));
    for (var i = 0; i < LINKS; i++) {
        let share = (f32(i) + 1.0) / 3.0;
        let bend = select(mix(shares[i], 1.0 + 0.06 * share, flat_share), 1.0, is_stiff);
        let v = pressed[i] * bend + plant.droop * share * (1.6 - 1.1 * flat_share);
        leans[i] = v * min(1.0, 1.55 / max(length(v), 1e-5));
    }
    return leans;
}

// A plant that stands still in leans.
fn still(plant: Plant, leans_in: array<vec2<f32>, 3>) -> Sway {
    var leans = leans_of(plant, leans_in);
    return Sway(array<vec4<f32>, 3>(vec4<f32>(leans[0], 0.0, 0.0), vec4<f32>(leans[1], 0.0, 0.0), vec4<f32>(leans[2], 0.0, 0.0)));
}

// What bends a plant that stands somewhere.
struct Bending {
    // Wind over the ground (m/s).
    wind: vec2<f32>,
    // Factor on it that neighbours share; three numbers of the plant's own, 0..1.
    gust: f32,
    own: vec3<f32>,
    // State of the bend field, and how much of that is shown.
    field: vec3<f32>,
    share: f32,
}

fn bending_at(plant: Plant, grid: vec2<i32>, index: u32) -> Bending {
    let p = plant.root.xz;
    return Bending(wind_at(plant.root, 0.0).xz, gust_at(p), random3(grid, index + 47u), bend_at(p, 0.0, 0), field_share(p));
}

// A plant's own factor on the wind.
fn own_gust(bending: Bending) -> f32 {
    return bending.gust * (0.9 + 0.2 * bending.own.y);
}

// How the thirds of a plant lean (rad) of which nothing is remembered: the upper ones trail the lowest (001 section 4.5).
fn trailing_leans(plant: Plant, bending: Bending, gust: f32) -> array<vec2<f32>, 3> {
    let kind = kinds.list[plant.kind];
    let lag_secs = select(0.0, kind.lag.z, kind.shape.x > 1.5);
    let held = lean_of_wind(bending.wind * gust, kind.tip.w) * give_of(plant);
    var leans = array<vec2<f32>, 3>(held, held, held);
    leans[0] += lean_of_bend(bending.field) * bending.share;
    for (var i = 1; i < select(1, 3, bending.share > 0.0); i++) {
        leans[i] += trailing_lean(plant.root.xz, 0.0, bending.field, kind, lag_secs * f32(i) * 0.5) * bending.share;
    }
    return leans;
}

fn append(list: u32, blade: Blade) {
    let number = atomicAdd(&counters.drawn[list], 1u);
    let fine = plants.capacities.x;
    let others = plants.capacities.y;
    let heads = plants.capacities.z;
    let capacity = array<u32, 5>(fine, others, others, heads, heads)[list];
    // Blades of one segment fill the place of the coarse ones from its end, far heads that of the near ones.
    let first = array<u32, 5>(0u, fine, fine + others - 1u, fine + others, fine + others + heads - 1u)[list];
    if number < capacity {
        drawn[select(first + number, first - number, list == SINGLE || list == FAR_HEAD)] = blade;
    }
}

// Whether a blade may be in view, whose curve lies in the hull of its control points.
fn is_blade_seen(root: vec3<f32>, points: array<vec3<f32>, 3>, width: f32) -> bool {
    let centre = 0.5 * points[2];
    let reach = max(length(centre), max(distance(centre, points[0]), distance(centre, points[1])));
    return (plants.counts.y == 0u) | is_seen(root + centre, 1.1 * reach + 0.5 * WIDER * width);
}

// The grass about a plant, whose colour has a tint, as it is seen from afar, and how much of it shows between the plants that are drawn.
fn about(plant: Plant, tint: vec3<f32>, lean: vec2<f32>, distance_m: f32, light: f32) -> vec4<f32> {
    let kind = kinds.list[plant.kind];
    let view = normalize(plant.root - frame.eye.xyz);
    let between = bare_between(distance_m, kind, view, plant.normal);
    if between <= 0.02 && contrast(distance_m) >= 1.0 {
        return vec4<f32>(0.0);
    }
    return vec4<f32>(sward_color(plant.root, plant.normal, kind, tint, lean, view, light), between);
}

fn show(plant: Plant, points: array<vec3<f32>, 3>, grown: f32, distance_m: f32, kind: f32) {
    let pixel_m = distance_m * frame.screen.z;
    let thinned = inverseSqrt(density(distance_m, plants.shape.y));
    let least_m = select(pixel_m * plants.time.w, 0.0, plants.counts.z != 0u);
    let width = max(plant.width * thinned, least_m) * min(grown * 2.0, 1.0);
    if !is_blade_seen(plant.root, points, width) {
        return;
    }
    let length_m = plant.height * grown;
    // Where they are laid over each other in order, all fine ones are nearer than the others.
    let own = 1.0 + select(FINE_SPREAD, 0.0, plants.counts.z != 0u) * (2.0 * fract(plant.hue * 97.0) - 1.0);
    let list = select(select(COARSE, SINGLE, length_m < SINGLE_PX * own * pixel_m), FINE, distance_m < plants.shape.z * own);
    let segments = select(select(1u, plants.steps.w, list == COARSE), plants.steps.z, list == FINE);
    let along = drawn_out(points, length_m, segments);
    var blade: Blade;
    blade.root = vec4<f32>(plant.root, width);
    let p = plant.root + points[1];
    let light = cloud_light(p.xz) * sun_visible(p);
    blade.points[0] = vec4<f32>(along[0], plant.side);
    blade.points[1] = vec4<f32>(along[1], f32(plant.kind) + plant.hue);
    blade.points[2] = vec4<f32>(along[2], light);
    let drift = drift_at(plant.root.xz);
    blade.about = about(plant, tint_of(drift), points[2].xz / plant.height, distance_m, light);
    blade.place = vec4<f32>(drift, plant.normal.xz);
    blade.air = air_before(p);
    if plant.is_flower {
        // Heads too small to be seen thin out, and those left are as large as can be seen.
        let small = max(max(pixel_m * plants.time.w / HEAD_RADIUS_M, distance_m / plants.reach.y), 1.0);
        if fract(kind * 37.7) * small * small <= 1.0 {
            var head = blade;
            head.root.w = small;
            head.points[1].w = kind;
            let is_reference = plants.time.w == 0.0;
            let is_far = HEAD_RADIUS_M * small < FAR_HEAD_PX * own * pixel_m;
            append(select(HEAD, FAR_HEAD, is_far & !is_reference), head);
        }
    }
    append(list, blade);
}

// How far a plant has grown in where the density is thinning, and where the last ones end: 0 gone, 1 whole, as all are nearer than nine tenths of the distance
// of full density.
fn growth(index: u32, distance_m: f32) -> f32 {
    let near = plants.shape.y / max(distance_m, 0.01);
    let places = f32(plants.counts.x);
    let kept = places * near * near;
    let thinning = clamp((kept - f32(index)) / (0.18 * min(kept, places)), 0.0, 1.0);
    let staying = 1.0 - plants.reach.z * smoothstep(frame.reach.x, frame.reach.y, distance_m);
    return select(thinning * staying, 0.0, distance_m >= frame.reach.y);
}

@compute @workgroup_size(64)
fn bend_near(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= standing[0] {
        return;
    }
    let at = standing[LISTED + id.x];
    let index = at % plants.counts.x;
    let slot = plants.slots[at / plants.counts.x];
    let grid = slot.xy;
    let plant = plant_at(grid, index, plant_place(grid, index), is_flower_at(grid, index));
    let distance_m = distance(plant.root, frame.eye.xyz);
    let grown = growth(index, distance_m);
    let kind = kinds.list[plant.kind];
    let bending = bending_at(plant, grid, index);
    let gust = own_gust(bending);
    let field_lean = lean_of_bend(bending.field) * bending.share;
    let held = leans_of(plant, array<vec2<f32>, 3>(field_lean, field_lean, field_lean));
    let give = give_of(plant);
    let nature = BladeNature(plant.height, plant.frequency, plants.shape.w, kind.tip.w * 0.01 * give);

    var sway = sways[at];
    // What was not moved for a while stands still when it comes into view.
    if moved[at] < u32(slot.z) || plants.counts.w - moved[at] > 1u {
        let lean = field_lean + lean_of_wind(bending.wind * gust, kind.tip.w) * give;
        sway = still(plant, array<vec2<f32>, 3>(lean, lean, lean));
    }
    let steps = plants.steps.x + u32(none_of(distance_m));
    for (var step = 0u; step < steps; step++) {
        let points = points_of(sway, plant.height);
        let winds = array<vec2<f32>, 3>(
            blowing(plant.root + points[0], points[0].y, gust),
            blowing(plant.root + points[1], points[1].y, gust),
            blowing(plant.root + points[2], points[2].y, gust),
        );
        sway = settle(advance(sway, nature, held, winds, plants.steps.y, plants.time.x), plant.height, plant.normal, plant.root);
    }
    sways[at] = sway;
    moved[at] = plants.counts.w;

    // On its way out of the near grids a plant comes to stand as those beyond do.
    let away = abs(plant.root.xz - frame.eye.xz) / plants.shape.x;
    let beyond = standing_far(plant, bending);
    let share = smoothstep(0.6, 1.0, max(away.x, away.y));
    for (var i = 0; i < LINKS; i++) {
        sway.links[i] = mix(sway.links[i], beyond.links[i], share);
    }
    if grown > 0.01 {
        show(plant, points_of(sway, plant.height), grown, distance_m, flower_at(grid, index, plant.root.xz));
    }
}

// A plant of which nothing is remembered.
fn standing_far(plant: Plant, bending: Bending) -> Sway {
    let flutter = 1.0 + 0.065 * sin(frame.eye.w * mix(6.0, 9.0, bending.own.x) + bending.own.z * TAU);
    let leans = trailing_leans(plant, bending, own_gust(bending) * flutter);
    return settle(still(plant, leans), plant.height, plant.normal, plant.root);
}

// How much of a blade's lean a plant shows in the same wind.
fn give_of(plant: Plant) -> f32 {
    return select(1.0, FLOWER_GIVE, plant.is_flower);
}

// Wind over the ground at a control point (m/s), no stronger than what still bends grass farther.
fn blowing(p: vec3<f32>, above_m: f32, gust: f32) -> vec2<f32> {
    let wind = wind_at(p, max(above_m, 0.0)).xz * gust;
    return wind * min(1.0, 10.0 / max(length(wind), 1e-3));
}

@compute @workgroup_size(64)
fn bend_far(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= standing[1] {
        return;
    }
    let listed = standing[LISTED + 9u * plants.counts.x + id.x];
    let chunk = chunks[listed / 64u];
    let grid = chunk.xy;
    let index = u32(chunk.z) + listed % 64u;
    let plant = plant_at(grid, index, plant_place(grid, index), is_flower_at(grid, index));
    let distance_m = distance(plant.root, frame.eye.xyz);
    let grown = growth(index, distance_m);
    if grown <= 0.01 {
        return;
    }
    show(plant, points_of(standing_far(plant, bending_at(plant, grid, index)), plant.height), grown, distance_m, flower_at(grid, index, plant.root.xz));
}

// Indirect draws of 64 plants an instance.
@compute @workgroup_size(5)
fn finish(@builtin(local_invocation_index) list: u32) {
    if list < 5u {
        let count = min(atomicLoad(&counters.drawn[list]), plants.capacities[array<u32, 5>(0u, 1u, 1u, 2u, 2u)[list]]);
        draws[list * 5u + 1u] = (count + 63u) / 64u;
    }
}
