// Single plants: how each blade and flower stem stands in this frame, and which of them are seen.
//
// Near plants (nine grids about the camera) keep their control points from frame to frame and obey drag, stiffness and the
// length of the blade (000 section 3.2); those farther away stand as the bend field and the wind of the moment would have them.

struct Plants {
    // Grid (x, z) that lives in each of the nine slots; 1 in z when it has just moved in.
    slots: array<vec4<i32>, 9>,
    // Blades of a near grid, flowers among them; grids farther away, their blades.
    counts: vec4<u32>,
    // Capacities of the drawn lists: fine blades, coarse blades, flowers.
    capacities: vec4<u32>,
    // Side of a grid (m), distance of full density (m), distance up to which blades are fine (m), sub-steps due: the
    // whole ones are done in this frame.
    shape: vec4<f32>,
}

// Offsets of three control points from the root (m), now and one sub-step ago.
struct Posture {
    now: array<vec4<f32>, 3>,
    before: array<vec4<f32>, 3>,
}

struct Counters {
    drawn: array<atomic<u32>, 4>,
}

@group(1) @binding(0) var<uniform> plants: Plants;
@group(1) @binding(1) var<storage, read_write> postures: array<Posture>;
@group(1) @binding(2) var<storage, read_write> drawn: array<Blade>;
@group(1) @binding(3) var<storage, read_write> counters: Counters;
@group(1) @binding(4) var<storage, read> far_grids: array<vec4<i32>>;
@group(1) @binding(5) var<storage, read_write> draws: array<u32>;

// Length of a sub-step (s); twin of the constant in `blades.rs`.
const STEP_SECS: f32 = 1.0 / 120.0;

const FINE: u32 = 0u;
const COARSE: u32 = 1u;
const FLOWER: u32 = 2u;

struct Plant {
    root: vec3<f32>,
    height: f32,
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
    let share = fract(start + vec2<f32>(f32(index) * 0.7548776662, f32(index) * 0.5698402910));
    return (vec2<f32>(grid) + share) * plants.shape.x + jitter * 0.12;
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
    let meadow = noise(p / 14.0).a;
    var plant: Plant;
    plant.root = vec3<f32>(p.x, ground_height(p), p.y);
    plant.normal = ground_normal(p);
    // Kinds mingle where they meet.
    plant.kind = kind_at(p + (r.xz - 0.5) * 0.7);
    let kind = kinds.list[plant.kind];
    let grown = mix(0.72, 1.22, meadow) * mix(0.78, 1.15, shared_by.x);
    plant.height = kind.root.w * (1.0 + frame.blade.y * (2.0 * r.y - 1.0)) * grown;
    plant.width = frame.blade.z * kind.shape.w * mix(0.75, 1.3, r.z);
    let own = (s.x - 0.5) * TAU;
    let leaning = away * 2.2 + (shared_by.yz - 0.5) * 0.5 + vec2<f32>(cos(own), sin(own)) * mix(0.08, 0.42, s.y * s.y);
    plant.droop = leaning * kind.shape.z;
    plant.side = own + s.z * 1.3;
    plant.hue = clamp(shared_by.y * 0.45 + s.z * 0.55, 0.0, 0.999);
    plant.is_flower = is_flower;
    if is_flower {
        // Petals stand at 0.65 of the tallest blades' height (000 section 3.3).
        plant.height = kind.root.w * (1.0 + frame.blade.y) * mix(0.65, 0.90, r.y) * max(grown, 0.9);
        plant.width = frame.blade.z * kind.shape.w * 0.45;
        plant.droop = leaning * 0.35;
    }
    return plant;
}

// Control points of a plant whose thirds lean by `leans_in` (rad) and that droops of itself: each third leans more than the one
// below, but for plants of one segment.
fn posture_of(plant: Plant, leans_in: array<vec2<f32>, 3>) -> array<vec3<f32>, 3> {
    var leans = leans_in;
    var points: array<vec3<f32>, 3>;
    var at = vec3<f32>(0.0);
    let is_stiff = kinds.list[plant.kind].shape.x < 1.5;
    let flat_share = smoothstep(0.5, 1.3, length(leans[0]));
    for (var i = 0; i < 3; i++) {
        let share = (f32(i) + 1.0) / 3.0;
        let bend = select(mix(0.55 + 0.75 * share, 1.0 + 0.06 * share, flat_share), 1.0, is_stiff);
        let v = leans[i] * bend + plant.droop * share * (1.6 - 1.1 * flat_share);
        let angle = min(length(v), 1.55);
        let direction = v / max(length(v), 1e-5);
        at += vec3<f32>(direction.x * sin(angle), cos(angle), direction.y * sin(angle)) * (plant.height / 3.0);
        points[i] = above_ground(at, plant.normal);
    }
    return points;
}

// How the thirds of a plant lean (rad) of which nothing is remembered: the upper ones trail the lowest (001 section 4.5).
fn trailing_leans(plant: Plant, gust: f32) -> array<vec2<f32>, 3> {
    let kind = kinds.list[plant.kind];
    let p = plant.root.xz;
    let lag_secs = select(0.0, kind.lag.z, kind.shape.x > 1.5);
    let share = field_share(p);
    let now = bend_at(p, 0.0, 0);
    let held = lean_of_wind(wind_at(plant.root, 0.0).xz * gust, kind.tip.w);
    var leans: array<vec2<f32>, 3>;
    for (var i = 0; i < 3; i++) {
        leans[i] = held;
        if share > 0.0 {
            leans[i] += trailing_lean(p, 0.0, now, kind, lag_secs * f32(i) * 0.5) * share;
        }
    }
    return leans;
}

fn above_ground(offset: vec3<f32>, normal: vec3<f32>) -> vec3<f32> {
    let depth = 0.015 - dot(offset, normal);
    return offset + normal * max(depth, 0.0);
}

fn is_seen(centre: vec3<f32>, radius: f32) -> bool {
    let m = transpose(frame.projection_from_world);
    let c = vec4<f32>(centre, 1.0);
    let left = m[3] + m[0];
    let right = m[3] - m[0];
    let low = m[3] + m[1];
    let high = m[3] - m[1];
    return dot(left, c) > -radius * length(left.xyz) && dot(right, c) > -radius * length(right.xyz)
        && dot(low, c) > -radius * length(low.xyz) && dot(high, c) > -radius * length(high.xyz) && dot(m[3], c) > -radius;
}

// Share of the plants that stand at a distance; the rest make room, and those left grow wider.
fn density(distance_m: f32) -> f32 {
    return min(pow(plants.shape.y / max(distance_m, 0.01), 1.25), 1.0);
}

fn append(list: u32, blade: Blade) {
    let capacity = plants.capacities[list];
    let number = atomicAdd(&counters.drawn[list], 1u);
    if number < capacity {
        var base = 0u;
        if list > 0u { base += plants.capacities.x; }
        if list > 1u { base += plants.capacities.y; }
        drawn[base + number] = blade;
    }
}

fn show(plant: Plant, points: array<vec3<f32>, 3>, grown: f32, distance_m: f32, kind: f32) {
    let thinned = density(distance_m);
    var blade: Blade;
    let pixel_m = distance_m * frame.screen.z;
    let width = plant.width * pow(thinned, -0.62);
    blade.root = vec4<f32>(plant.root, max(width, pixel_m * 0.9) * min(grown * 2.0, 1.0));
    let p = plant.root + points[1];
    let light = cloud_light(p.xz) * sun_visible(p);
    blade.points[0] = vec4<f32>(points[0] * grown, plant.side);
    blade.points[1] = vec4<f32>(points[1] * grown, f32(plant.kind) + plant.hue);
    blade.points[2] = vec4<f32>(points[2] * grown, light);
    if plant.is_flower {
        var head = blade;
        head.points[1].w = kind;
        append(FLOWER, head);
    }
    append(select(COARSE, FINE, distance_m < plants.shape.z), blade);
}

// How far a plant has grown in where the density is thinning: 0 gone, 1 whole.
fn growth(index: u32, count: u32, distance_m: f32) -> f32 {
    let kept = f32(plants.counts.x) * density(distance_m);
    let thinning = clamp((kept - f32(index)) / (0.18 * kept), 0.0, 1.0);
    return thinning * (1.0 - smoothstep(frame.reach.x, frame.reach.y, distance_m));
}

@compute @workgroup_size(64)
fn bend_near(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = id.x;
    let count = plants.counts.x;
    if index >= count {
        return;
    }
    let slot = plants.slots[id.y];
    let grid = slot.xy;
    let place = plant_place(grid, index);
    let distance_m = distance(place, frame.eye.xz);
    let share = grass_share(place);
    if random3(grid, index + 31u).x > share * 1.02 - 0.02 {
        return;
    }
    let is_flower = index % max(count / max(plants.counts.y, 1u), 1u) == 0u && plants.counts.y > 0u;
    let plant = plant_at(grid, index, place, is_flower);
    // Where the field and the wind hold the plant: drag in a steady wind balances stiffness there.
    let gust = gust_at(plant.root.xz) * (0.9 + 0.2 * random3(grid, index + 47u).y);
    let kind = kinds.list[plant.kind];
    let lean = lean_at(plant.root, 0.0, gust, kind.tip.w);
    let held = posture_of(plant, array<vec2<f32>, 3>(lean, lean, lean));
    let at = id.y * count + index;

    var now: array<vec3<f32>, 3>;
    var before: array<vec3<f32>, 3>;
    if slot.z != 0 {
        now = held;
        before = held;
    } else {
        for (var i = 0; i < 3; i++) {
            now[i] = postures[at].now[i].xyz;
            before[i] = postures[at].before[i].xyz;
        }
    }

    // Stiffness per mass falls with the height. The drag of air that passes at |u - v|^2 is taken as linear in v about the wind
    // u: it damps the plant's own motion the more, the farther that wind bends it.
    let mass = select(1.0, 2.2, plant.is_flower);
    let stiff = 95.0 * sqrt(0.8 / plant.height) / mass * kind.shape.y;
    let wind = wind_at(plant.root, 0.0).xz * gust;
    let drag = 2.0 * plant.height * sin(length(lean_of_wind(wind, kind.tip.w))) / max(length(wind), 1e-3);
    for (var step = 0; step < i32(plants.shape.w); step++) {
        for (var i = 0; i < 3; i++) {
            let share_of_height = (f32(i) + 1.0) / 3.0;
            let k = stiff * mix(2.2, 1.0, share_of_height);
            let v = (now[i] - before[i]) / STEP_SECS;
            let pull = (held[i] - now[i]) * k - v * (0.20 * sqrt(k) + drag * share_of_height * k);
            let next = now[i] + v * STEP_SECS + pull * (STEP_SECS * STEP_SECS);
            before[i] = now[i];
            now[i] = next;
        }
        keep_length(&now, plant);
    }
    if !all(abs(now[2]) < vec3<f32>(100.0)) {
        now = held;
        before = held;
    }
    for (var i = 0; i < 3; i++) {
        postures[at].now[i] = vec4<f32>(now[i], 0.0);
        postures[at].before[i] = vec4<f32>(before[i], 0.0);
    }

    let grown = growth(index, count, distance_m);
    if grown <= 0.01 || !is_seen(plant.root + vec3<f32>(0.0, plant.height * 0.5, 0.0), plant.height * 0.75) {
        return;
    }
    // Between the last two sub-steps, as far as the next is due.
    var shown: array<vec3<f32>, 3>;
    for (var i = 0; i < 3; i++) {
        shown[i] = mix(before[i], now[i], fract(plants.shape.w));
    }
    push_aside(&shown, plant);
    show(plant, shown, grown, distance(plant.root, frame.eye.xyz), random3(grid, index + 61u).z);
}

// Length constraint from root to tip, never below the ground.
fn keep_length(points: ptr<function, array<vec3<f32>, 3>>, plant: Plant) {
    var below = vec3<f32>(0.0);
    let segment = plant.height / 3.0;
    for (var i = 0; i < 3; i++) {
        let along = (*points)[i] - below;
        let at = below + along * (segment / max(length(along), 1e-5));
        (*points)[i] = above_ground(at, plant.normal);
        below = (*points)[i];
    }
}

// Spheres push plants aside that root within their circle: the first point inside moves out to the sphere, and the rest
// of the plant is tangent there (000 section 6.2).
fn push_aside(points: ptr<function, array<vec3<f32>, 3>>, plant: Plant) {
    for (var s = 0; s < i32(frame.clouds.w); s++) {
        let centre = frame.spheres[s].xyz - plant.root;
        let radius = frame.spheres[s].w;
        if dot(centre.xz, centre.xz) > radius * radius {
            continue;
        }
        var below = vec3<f32>(0.0);
        for (var i = 0; i < 3; i++) {
            let out = (*points)[i] - centre;
            if dot(out, out) < radius * radius {
                let moved = centre + out * (radius / max(length(out), 1e-4));
                (*points)[i] = moved;
                let along = normalize(moved - below);
                for (var j = i + 1; j < 3; j++) {
                    (*points)[j] = (*points)[j - 1] + along * (plant.height / 3.0);
                }
                break;
            }
            below = (*points)[i];
        }
        keep_length(points, plant);
    }
}

@compute @workgroup_size(64)
fn bend_far(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = id.x;
    if index >= plants.counts.w {
        return;
    }
    let grid = far_grids[id.y].xy;
    let place = plant_place(grid, index);
    let flat_m = distance(place, frame.eye.xz);
    let grown = growth(index, plants.counts.x, flat_m);
    if grown <= 0.01 {
        return;
    }
    let share = grass_share(place);
    if random3(grid, index + 31u).x > share * 1.02 - 0.02 {
        return;
    }
    let is_flower = index % max(plants.counts.x / max(plants.counts.y, 1u), 1u) == 0u && plants.counts.y > 0u;
    let plant = plant_at(grid, index, place, is_flower);
    if !is_seen(plant.root + vec3<f32>(0.0, plant.height * 0.5, 0.0), plant.height * 0.75) {
        return;
    }
    let r = random3(grid, index + 47u);
    let flutter = 1.0 + 0.065 * sin(frame.eye.w * mix(6.0, 9.0, r.x) + r.z * TAU);
    let leans = trailing_leans(plant, gust_at(plant.root.xz) * (0.9 + 0.2 * r.y) * flutter);
    show(plant, posture_of(plant, leans), grown, distance(plant.root, frame.eye.xyz), random3(grid, index + 61u).z);
}

// Indirect draws of 64 plants an instance.
@compute @workgroup_size(4)
fn finish(@builtin(local_invocation_index) list: u32) {
    if list < 3u {
        let count = min(atomicLoad(&counters.drawn[list]), plants.capacities[list]);
        draws[list * 5u + 1u] = (count + 63u) / 64u;
    }
}
