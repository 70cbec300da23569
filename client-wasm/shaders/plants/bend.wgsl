// Pose of each blade and flower stem that `sift.wgsl` has listed, and culling.
//
// Near plants (nine grids around the camera) are simulated: they keep the sway of their links from frame to frame and obey drag and
// stiffness (Zhang, section 3.2; `blade.wgsl`). Those farther away follow the bend field and the current wind.

import package::constants::{
    BEND_SATURATES_M_PER_S, CHUNK, COARSE_LIST, DRAW_WORDS, FAR_HEAD_LIST, FINE_LIST, FINE_SPREAD, FLAT_RAD, GROWTH_BY_TUFT, HEAD_LIST, LINKS,
    NEAR_SLOTS, PLANT_LISTS, SINGLE_LIST, TAU, WIND_SHAPE,
};
import package::inputs::bend_atlas::{bend_at, far_lean, field_fraction, lean_of_bend, trailing_lean};
import package::inputs::frame::{frame, runtime_zero};
import package::inputs::frustum::is_seen;
import package::inputs::grass_kinds::{kind_at, kinds};
import package::inputs::noise::noise;
import package::inputs::random::random3;
import package::inputs::shadows::sun_visible;
import package::inputs::sward_shade::{shade_at, sun_over_grass};
import package::inputs::wind::{gust_at, lean_of_wind};
import package::land_and_sky::clouds::cloud_light;
import package::land_and_sky::grass_color::{drift_at, tint_of};
import package::land_and_sky::grass_light::even_depth;
import package::land_and_sky::ground::{fed, ground_height, ground_normal};
import package::land_and_sky::haze::air_before;
import package::land_and_sky::snow::{laden_mass_at, with_snow};
import package::land_and_sky::sward::{density, bare_between, contrast, sward_color};
import package::plants::backbone::{drawn_out, WIDER};
import package::plants::blade::{advance, BladeNature, Link, points_of, settle, Sway};
import package::plants::drawn_blade::Blade;
import package::plants::force_field::sheltered_at;
import package::plants::grid_plants::{plants, chunks, growth, HEAD_RADIUS_M, LISTED, plant_place};
import package::plants::sift::{find_ground, sift_far, sift_near};

struct BladeCounters {
    drawn: array<atomic<u32>, PLANT_LISTS>,
}

@group(1) @binding(1) var<storage, read_write> sways: array<Sway>;
@group(1) @binding(2) var<storage, read_write> drawn: array<Blade>;
@group(1) @binding(3) var<storage, read_write> counters: BladeCounters;
@group(1) @binding(5) var<storage, read_write> draws: array<u32>;
// Numbers of near and of far plants that are listed; indices of the near ones in `sways`; chunk · `CHUNK` + index in the chunk of the far ones.
@group(1) @binding(6) var<storage, read> standing: array<u32>;
// Number of the frame that last moved each near plant.
@group(1) @binding(7) var<storage, read_write> moved: array<u32>;

// Screen radius below which a head is drawn as a disc (px).
const FAR_HEAD_PX: f32 = 4.0;

// Screen height below which a blade is one segment (px).
const SINGLE_PX: f32 = 12.0;

// Height of petals relative to that of the blade at their position, and its variation (Zhang, section 3.3).
const PETALS_FRACTION: f32 = 0.65;
const PETALS_SPREAD: f32 = 0.05;
// Lean of a flower relative to that of a blade in the same wind: it is heavier, and slower by the square root of this (Zhang, section 3.4).
const FLOWER_GIVE: f32 = 0.55;

struct Plant {
    // Root (m).
    root_m: vec3<f32>,
    // Length (m).
    height_m: f32,
    // Lowest natural frequency (rad/s).
    frequency_rad_per_s: f32,
    width_m: f32,
    // Lean by its own weight, as a vector (rad).
    droop_rad: vec2<f32>,
    // Angle of the side of the strip (rad).
    side_rad: f32,
    hue: f32,
    is_flower: bool,
    kind: u32,
    normal: vec3<f32>,
}

// Random draw whether a plant is a flower; the probability falls along the sequence, so that flowers thin out more slowly than blades.
fn is_flower(grid: vec2<i32>, index: u32, first_lot: f32, power: f32) -> bool {
    return random3(grid, index + 22051u).x < first_lot * pow(f32(index) + 1.0, power);
}

fn is_flower_at(grid: vec2<i32>, index: u32) -> bool {
    return is_flower(grid, index, plants.first_flower, plants.flower_power);
}

// Kind of a flower, one of six, as a fraction; in clusters where three of four are of one kind.
fn flower_at(grid: vec2<i32>, index: u32, place: vec2<f32>) -> f32 {
    let lot = random3(grid, index + 61u).yz;
    let drift = floor(6.0 * fract(5.0 * noise(place / 37.0).b));
    return select(lot.y, (drift + lot.y) / 6.0, lot.x < 0.75);
}

fn plant_at(grid: vec2<i32>, index: u32, place: vec2<f32>, is_flower: bool) -> Plant {
    let r = random3(grid, index + 7919u);
    let s = random3(grid, index + 15013u);
    // Plants of a tuft are moved towards its centre and share height, colour and lean.
    let tuft = vec2<i32>(floor(place / 0.42));
    let shared_by = random3(tuft, 3u);
    let centre = (vec2<f32>(tuft) + 0.25 + 0.5 * random3(tuft, 5u).xy) * 0.42;
    let p = mix(place, centre, 0.34 * r.x);
    let away = p - centre;
    var plant: Plant;
    plant.root_m = vec3<f32>(p.x, ground_height(p), p.y);
    plant.normal = ground_normal(p);
    // Kinds mix where they meet.
    plant.kind = kind_at(p + (r.xz - 0.5) * 0.7);
    let kind = kinds.list[plant.kind];
    let grown = fed(p) * mix(GROWTH_BY_TUFT[0], GROWTH_BY_TUFT[1], shared_by.x);
    plant.height_m = kind.height_m * (1.0 + frame.height_variation * (2.0 * r.y - 1.0)) * grown;
    plant.frequency_rad_per_s = kind.frequency_rad_per_s * kind.height_m / plant.height_m;
    plant.width_m = frame.blade_width_m * kind.width * mix(0.75, 1.3, r.z);
    let own = (s.x - 0.5) * TAU;
    let leaning = away * 2.2 + (shared_by.yz - 0.5) * 0.5 + vec2<f32>(cos(own), sin(own)) * mix(0.08, 0.42, s.y * s.y);
    plant.droop_rad = leaning * kind.droop;
    plant.side_rad = own + s.z * 1.3;
    plant.hue = clamp(shared_by.y * 0.45 + s.z * 0.55, 0.0, 0.999);
    plant.is_flower = is_flower;
    if is_flower {
        plant.height_m *= PETALS_FRACTION + PETALS_SPREAD * (2.0 * random3(grid, index + 22051u).y - 1.0);
        plant.frequency_rad_per_s *= sqrt(FLOWER_GIVE);
        plant.width_m = frame.blade_width_m * kind.width * 0.45;
        plant.droop_rad = leaning * 0.35;
    }
    let mass = laden_mass_at(p);
    plant.droop_rad *= mass;
    plant.frequency_rad_per_s *= inverseSqrt(mass);
    return plant;
}

// Leans (rad) of the thirds of a plant that wind and field bend by `leans_in` and that droops by its own weight: each leans more than the
// one below, except for plants of one segment.
fn leans_of(plant: Plant, leans_in: array<vec2<f32>, 3>) -> array<vec2<f32>, 3> {
    var pressed = leans_in;
    var fractions = WIND_SHAPE;
    var leans: array<vec2<f32>, 3>;
    let is_stiff = kinds.list[plant.kind].segments < 1.5;
    let flat_fraction = smoothstep(0.5, 1.3, length(pressed[0]));
    for (var i = 0; i < LINKS; i++) {
        let fraction = (f32(i) + 1.0) / 3.0;
        let bend = select(mix(fractions[i], 1.0 + 0.06 * fraction, flat_fraction), 1.0, is_stiff);
        let v = pressed[i] * bend + plant.droop_rad * fraction * (1.6 - 1.1 * flat_fraction);
        leans[i] = v * min(1.0, FLAT_RAD / max(length(v), 1e-5));
    }
    return leans;
}

// A plant at rest with given leans.
fn still(plant: Plant, leans_in: array<vec2<f32>, 3>) -> Sway {
    var leans = leans_of(plant, leans_in);
    let at_rest = vec2<f32>(0.0);
    return Sway(array<Link, 3>(Link(leans[0], at_rest), Link(leans[1], at_rest), Link(leans[2], at_rest)));
}

// Wind and bend field at a plant.
struct Bending {
    // Wind over the ground (m/s).
    wind: vec2<f32>,
    // Gust (m/s).
    gust: vec2<f32>,
    // Three random numbers of the plant, 0..1.
    own: vec3<f32>,
    // State of the bend field: θ (rad) and ω (rad/s).
    field: vec3<f32>,
    // Weight of the bend field.
    fraction: f32,
    // Lean of the repeated patch (rad).
    far_lean: vec2<f32>,
}

fn bending_at(plant: Plant, grid: vec2<i32>, index: u32) -> Bending {
    let p = plant.root_m.xz;
    let fraction = field_fraction(p);
    return Bending(
        sheltered_at(plant.root_m, 0.0),
        gust_at(p),
        random3(grid, index + 47u),
        bend_at(p, 0.0, 0),
        fraction,
        far_lean(p, 0.0, fraction),
    );
}

// Wind on a plant relative to that around it: neighbours shelter each other by chance.
fn exposure_of(bending: Bending) -> f32 {
    return 0.9 + 0.2 * bending.own.y;
}

// Leans of the thirds of a plant (rad) without simulation: the upper ones lag behind the lowest (Chen & Johan, section 4.5).
fn trailing_leans(plant: Plant, bending: Bending, exposure: f32) -> array<vec2<f32>, 3> {
    let kind = kinds.list[plant.kind];
    let lag_secs = select(0.0, kind.lag_secs, kind.segments > 1.5);
    let held = lean_of_wind((bending.wind + bending.gust) * exposure, kind.wind_bend_rad) * give_of(plant) + bending.far_lean;
    var leans = array<vec2<f32>, 3>(held, held, held);
    leans[0] += lean_of_bend(bending.field) * bending.fraction;
    for (var i = 1; i < select(1, 3, bending.fraction > 0.0); i++) {
        leans[i] += trailing_lean(plant.root_m.xz, 0.0, bending.field, kind, lag_secs * f32(i) * 0.5) * bending.fraction;
    }
    return leans;
}

fn append(list: u32, blade: Blade) {
    let number = atomicAdd(&counters.drawn[list], 1u);
    let fine = plants.fine_capacity;
    let others = plants.other_capacity;
    let heads = plants.head_capacity;
    let capacity = array<u32, 5>(fine, others, others, heads, heads)[list];
    // Single-segment blades fill the buffer of the coarse ones from its end, and far heads that of the near ones.
    let first = array<u32, 5>(0u, fine, fine + others - 1u, fine + others, fine + others + heads - 1u)[list];
    if number < capacity {
        drawn[select(first + number, first - number, list == SINGLE_LIST || list == FAR_HEAD_LIST)] = blade;
    }
}

// Whether a blade may be in view. The strip is as long as the links, so that it is at most half that length from the middle between root and tip.
fn is_blade_seen(root: vec3<f32>, points: array<vec3<f32>, 3>, width: f32) -> bool {
    let centre = 0.5 * points[2];
    let reach = 0.5 * (length(points[0]) + distance(points[0], points[1]) + distance(points[1], points[2]));
    return (plants.culls == 0u) | is_seen(root + centre, 1.1 * reach + 0.5 * WIDER * width);
}

// Colour of the grass around a plant as seen from afar, and how much of it shows between the drawn plants.
fn about(plant: Plant, tint: vec3<f32>, lean: vec2<f32>, distance_m: f32, light: f32) -> vec4<f32> {
    let kind = kinds.list[plant.kind];
    let view = normalize(plant.root_m - frame.eye_m);
    let between = bare_between(distance_m, kind, view, plant.normal);
    if between <= 0.02 && contrast(distance_m) >= 1.0 {
        return vec4<f32>(0.0);
    }
    let shade = shade_at(plant.root_m.xz);
    let grass = sward_color(plant.root_m, plant.normal, kind, tint, lean, view, light, shade);
    return vec4<f32>(with_snow(grass, plant.root_m, plant.normal, kind, view, light, shade), between);
}

fn show(plant: Plant, points: array<vec3<f32>, 3>, grown: f32, distance_m: f32, kind: f32) {
    let pixel_m = distance_m * frame.pixel_rad;
    let thinned = inverseSqrt(density(distance_m, plants.full_density_m));
    let least_m = select(pixel_m * plants.thinnest_px, 0.0, plants.is_ordered != 0u);
    let width = max(plant.width_m * thinned, least_m) * min(grown * 2.0, 1.0);
    if !is_blade_seen(plant.root_m, points, width) {
        return;
    }
    let length_m = plant.height_m * grown;
    // If blades are drawn in order, all fine blades must be nearer than the others.
    let own = 1.0 + select(FINE_SPREAD, 0.0, plants.is_ordered != 0u) * (2.0 * fract(plant.hue * 97.0) - 1.0);
    let list = select(select(COARSE_LIST, SINGLE_LIST, length_m < SINGLE_PX * own * pixel_m), FINE_LIST, distance_m < plants.fine_m * own);
    let segments = select(select(1u, plants.coarse_segments, list == COARSE_LIST), plants.fine_segments, list == FINE_LIST);
    let along = drawn_out(points, length_m, segments);
    var blade: Blade;
    blade.root_m = plant.root_m;
    blade.width = width;
    let p = plant.root_m + points[1];
    let light = cloud_light(p.xz) * sun_visible(p);
    blade.low_m = along[0];
    blade.side_rad = plant.side_rad;
    blade.middle_m = along[1];
    blade.kind_and_hue = f32(plant.kind) + plant.hue;
    blade.tip_m = along[2];
    blade.sunlight = light;
    let drift = drift_at(plant.root_m.xz);
    blade.about = about(plant, tint_of(drift), points[2].xz / plant.height_m, distance_m, light);
    blade.drift = drift;
    blade.slope = plant.normal.xz;
    blade.air = air_before(p);
    if plant.is_flower {
        // Heads too small to be visible thin out, and the remaining ones are enlarged until they are visible.
        let small = max(max(pixel_m * plants.thinnest_px / HEAD_RADIUS_M, distance_m / plants.heads_thin_m), 1.0);
        if fract(kind * 37.7) * small * small <= 1.0 {
            var head = blade;
            head.width = small;
            head.kind_and_hue = kind;
            let around = kinds.list[plant.kind];
            head.sunlight *= sun_over_grass(shade_at(plant.root_m.xz + points[2].xz), points[2].y, even_depth(around), around.height_m);
            let is_reference = plants.thinnest_px == 0.0;
            let is_far = HEAD_RADIUS_M * small < FAR_HEAD_PX * own * pixel_m;
            append(select(HEAD_LIST, FAR_HEAD_LIST, is_far & !is_reference), head);
        }
    }
    append(list, blade);
}

@compute @workgroup_size(CHUNK)
fn bend_near(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= standing[0] {
        return;
    }
    let at = standing[LISTED + id.x];
    let index = at % plants.grid_plants;
    let slot = plants.slots[at / plants.grid_plants];
    let grid = slot.grid;
    let plant = plant_at(grid, index, plant_place(grid, index), is_flower_at(grid, index));
    let distance_m = distance(plant.root_m, frame.eye_m);
    let grown = growth(index, distance_m);
    let kind = kinds.list[plant.kind];
    let bending = bending_at(plant, grid, index);
    let exposure = exposure_of(bending);
    let field_lean = lean_of_bend(bending.field) * bending.fraction + bending.far_lean;
    let held = leans_of(plant, array<vec2<f32>, 3>(field_lean, field_lean, field_lean));
    let give = give_of(plant);
    let nature = BladeNature(plant.height_m, plant.frequency_rad_per_s, plants.damping_ratio, kind.wind_bend_rad * 0.01 * give);

    var sway = sways[at];
    // A plant that was not simulated in the previous frame starts at rest.
    if moved[at] < slot.moved_in || plants.frame_number - moved[at] > 1u {
        let lean = field_lean + lean_of_wind((bending.wind + bending.gust) * exposure, kind.wind_bend_rad) * give;
        sway = still(plant, array<vec2<f32>, 3>(lean, lean, lean));
    }
    let steps = plants.step_count + u32(runtime_zero(distance_m));
    for (var step = 0u; step < steps; step++) {
        let points = points_of(sway, plant.height_m);
        let winds = array<vec2<f32>, 3>(
            blowing(plant.root_m + points[0], points[0].y, bending.gust, exposure),
            blowing(plant.root_m + points[1], points[1].y, bending.gust, exposure),
            blowing(plant.root_m + points[2], points[2].y, bending.gust, exposure),
        );
        sway = settle(advance(sway, nature, held, winds, plants.integrator, plants.step_secs), plant.height_m, plant.normal, plant.root_m);
    }
    sways[at] = sway;
    moved[at] = plants.frame_number;

    // Towards the border of the near grids, a plant blends into the pose of those beyond.
    let away = abs(plant.root_m.xz - frame.eye_m.xz) / plants.grid_m;
    let beyond = standing_far(plant, bending);
    let fraction = smoothstep(0.6, 1.0, max(away.x, away.y));
    for (var i = 0; i < LINKS; i++) {
        sway.links[i].lean_rad = mix(sway.links[i].lean_rad, beyond.links[i].lean_rad, fraction);
        sway.links[i].rate_rad_per_s = mix(sway.links[i].rate_rad_per_s, beyond.links[i].rate_rad_per_s, fraction);
    }
    if grown > 0.01 {
        show(plant, points_of(sway, plant.height_m), grown, distance_m, flower_at(grid, index, plant.root_m.xz));
    }
}

// Pose of a plant that is not simulated.
fn standing_far(plant: Plant, bending: Bending) -> Sway {
    let flutter = 1.0 + 0.065 * sin(frame.time_secs * mix(6.0, 9.0, bending.own.x) + bending.own.z * TAU);
    let leans = trailing_leans(plant, bending, exposure_of(bending) * flutter);
    return settle(still(plant, leans), plant.height_m, plant.normal, plant.root_m);
}

// Lean of a plant relative to that of a blade in the same wind.
fn give_of(plant: Plant) -> f32 {
    return select(1.0, FLOWER_GIVE, plant.is_flower);
}

// Wind over the ground at a control point (m/s), limited to the speed beyond which grass bends no farther.
fn blowing(p: vec3<f32>, above_m: f32, gust: vec2<f32>, exposure: f32) -> vec2<f32> {
    let wind = (sheltered_at(p, max(above_m, 0.0)) + gust) * exposure;
    return wind * min(1.0, BEND_SATURATES_M_PER_S / max(length(wind), 1e-3));
}

@compute @workgroup_size(CHUNK)
fn bend_far(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= standing[1] {
        return;
    }
    let listed = standing[LISTED + NEAR_SLOTS * plants.grid_plants + id.x];
    let chunk = chunks[listed / CHUNK];
    let grid = chunk.grid;
    let index = chunk.first + listed % CHUNK;
    let plant = plant_at(grid, index, plant_place(grid, index), is_flower_at(grid, index));
    let distance_m = distance(plant.root_m, frame.eye_m);
    let grown = growth(index, distance_m);
    if grown <= 0.01 {
        return;
    }
    show(plant, points_of(standing_far(plant, bending_at(plant, grid, index)), plant.height_m), grown, distance_m, flower_at(grid, index, plant.root_m.xz));
}

// Indirect draws, with a chunk of plants per instance.
@compute @workgroup_size(PLANT_LISTS)
fn finish(@builtin(local_invocation_index) list: u32) {
    if list < PLANT_LISTS {
        let count = min(atomicLoad(&counters.drawn[list]), array<u32, 3>(plants.fine_capacity, plants.other_capacity, plants.head_capacity)[array<u32, 5>(0u, 1u, 1u, 2u, 2u)[list]]);
        draws[list * DRAW_WORDS + 1u] = (count + CHUNK - 1u) / CHUNK;
    }
}
