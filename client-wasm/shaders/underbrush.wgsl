// Underbrush: which plants are seen in this frame, what each of them feels, and at which level of detail it is drawn.

struct UnderbrushFrame {
    // Number of the frame, of those in which time passes; 1 to leave out what is not seen; plants and blocks of rows that there is room for.
    counts: vec4<u32>,
    // Time since the frame before (s); distance at which plants have shrunk to nothing (m); height of the force field (m); factor on the heights in the
    // picture below which plants are coarser.
    shape: vec4<f32>,
    // Corner of the force field and its extent, X and Z (m).
    forces: vec4<f32>,
    // Of each species: height (m), time constant (s), how far it reaches from its root at most (m), unused.
    species: array<vec4<f32>, 16>,
}

// A plant: place (m), size, species in the low byte, its make in the next, its site in the upper half of `site`.
struct Grown {
    at: vec2<f32>,
    size: f32,
    make: u32,
    heading: f32,
    site: u32,
}

// What a plant feels, as it follows the force field (004 section 4.3): pressure (Pa) and its rate; the frame that it was last seen in, of those in which time passes.
struct Felt {
    pressure: vec4<f32>,
    frame: u32,
}

// A plant as it is drawn: root (m), and size as it is shown; lean of the ground (rad), light and heading; pressure that it feels along
// X and Z (Pa), its make and the kind of the grass about it, and the spheres that it may touch, a bit each; height (m), hue, distance (m), and its own size.
struct Stand {
    root: vec4<f32>,
    lean: vec4<f32>,
    feels: vec4<f32>,
    about: vec4<f32>,
    // What the grass about it looks like from afar, and how much of that shows between the plants that are drawn.
    sward: vec4<f32>,
    // Tint of the grass there; the list that the plant is in.
    tint: vec4<f32>,
    // The land's normal; the first block of its rows.
    up: vec4<f32>,
    // What the air before it adds to its colour, and the share of that which the air lets through.
    air: vec4<f32>,
}

// Plants of each list; blocks of rows that plants asked for at their own levels, and that those which found none asked for at the coarsest.
struct Tally {
    drawn: array<atomic<u32>, 64>,
    blocks: atomic<u32>,
    spare: atomic<u32>,
}

// A species at a level of detail.
struct BrushList {
    // Rows of a plant; plants in an instance; components of a plant; first of its rows among those of all lists.
    rows: vec4<u32>,
    // First of its components among those of all lists; first of the listed plants; 1 if the nearest posture will do; unused.
    which: vec4<u32>,
    // Angles and loads of the tables; first of their steps among those of all lists; unused.
    nodes: vec4<u32>,
    // Drops of rain that make leaves tremble (1/(m²·s)); unused.
    rain: vec4<f32>,
}

struct BrushLists {
    list: array<BrushList, 64>,
}

@group(1) @binding(0) var<uniform> brush: UnderbrushFrame;
@group(1) @binding(1) var<storage, read> grown: array<Grown>;
@group(1) @binding(2) var<storage, read> chunks: array<vec2<u32>>;
@group(1) @binding(3) var<storage, read_write> felt: array<Felt>;
@group(1) @binding(4) var<storage, read_write> stands_out: array<Stand>;
@group(1) @binding(5) var<storage, read_write> tally: Tally;
@group(1) @binding(6) var<storage, read_write> listed: array<u32>;
// Which way the plant of each site fell, a byte each.
@group(1) @binding(7) var<storage, read> broken: array<u32>;
@group(1) @binding(8) var<storage, read_write> brush_draws: array<u32>;
@group(1) @binding(9) var forces: texture_3d<f32>;
@group(1) @binding(15) var<uniform> lists: BrushLists;
// How many plants may be seen, and which.
@group(1) @binding(17) var<storage, read_write> sifted: array<atomic<u32>>;
// Workgroups of those, for an indirect dispatch.
@group(1) @binding(18) var<storage, read_write> sifted_groups: array<atomic<u32>, 3>;
@group(1) @binding(19) var<storage, read> candidates: array<u32>;
// Of each block of rows the stand that it is of.
@group(1) @binding(20) var<storage, read_write> owners_out: array<u32>;
// Workgroups of `ribbons`, for an indirect dispatch.
@group(1) @binding(22) var<storage, read_write> ribbon_groups: array<u32, 3>;

const VARIANTS: u32 = 4u;
const FALL_PA: f32 = 8.0;
const LEVELS: u32 = 4u;
// Rows that a plant takes at once, of room and of invocations that do the same; twin of the constant in `underbrush/mod.rs`.
const BLOCK: u32 = 8u;
const BLOCKS_OF_GROUP: u32 = 64u / BLOCK;
const NOBODY: u32 = 0xffffffffu;

// Force on a silhouette (Pa, X and Z) so high above the ground at a root: that of the force field, or beyond it that of the wind alone.
fn pressure_at(root: vec3<f32>, above_m: f32) -> vec2<f32> {
    let at = (root.xz - brush.forces.xy) / brush.forces.zw;
    let inside = 1.0 - smoothstep(0.40, 0.49, max(abs(at.x - 0.5), abs(at.y - 0.5)));
    // Of the wind, and of what lingers of impulses.
    var force = vec4<f32>(0.0);
    if inside > 0.0 {
        force = textureSampleLevel(forces, clamped, vec3<f32>(at, above_m / brush.shape.z), 0.0) * inside;
    }
    if inside < 1.0 {
        let wind = wind_at(root, above_m);
        force += vec4<f32>(wind.xz * (0.6 * length(wind) * (1.0 - inside)), 0.0, 0.0);
    }
    // The wind comes in gusts, and is stiller down among the plants: a quarter-power law of the height, over the 2 m that the field's wind is from.
    let gust = gust_at(root.xz);
    return force.xy * (gust * gust * sqrt(clamp(0.5 * above_m, 0.02, 1.0))) + force.zw;
}

// A value that follows a target by a critically damped spring, in closed form; twin of `Following` in
// shared/src/plant/underbrush/constraint.rs.
fn followed(state: vec4<f32>, goal: vec2<f32>, settle_secs: f32, dt: f32) -> vec4<f32> {
    let taus = dt / settle_secs;
    let decay = exp(-taus);
    let off = state.xy - goal;
    let value = goal + off * ((1.0 + taus) * decay) + state.zw * (dt * decay);
    return vec4<f32>(value, off * (-taus / settle_secs * decay) + state.zw * ((1.0 - taus) * decay));
}

// Share of plants that is left at least where they are but a few pixels tall; twin of the constant in `underbrush/mod.rs`.
const FEWEST: f32 = 0.06;

// Pressure (Pa) on a plant that fell that way, in 255ths of a turn; 0: it stands. What is broken is bent there for good, as if pressed so; it lies at a fifth
// of its height, where it feels the square root of that of the air.
fn fallen(pressure: vec2<f32>, fall: u32) -> vec2<f32> {
    let heading = f32(fall) * (TAU / 255.0);
    return select(pressure, 0.45 * pressure + FALL_PA * vec2<f32>(cos(heading), sin(heading)), fall != 0u);
}

// A plant as the picture has room for it: root and height of its box (m), distance (m), height in the picture (px), a random number of its own, how much
// larger it is shown than it grew, and how much of that is left of it.
struct Shown {
    root: vec3<f32>,
    tall: f32,
    distance_m: f32,
    tall_px: f32,
    lot: f32,
    larger: f32,
    left: f32,
}

fn shown_of(plant: Grown) -> Shown {
    let nature = brush.species[plant.make & 255u];
    var shown: Shown;
    shown.root = vec3<f32>(plant.at.x, ground_height(plant.at), plant.at.y);
    shown.tall = max(nature.x, 0.5 * nature.z) * plant.size;
    shown.distance_m = distance(shown.root + vec3<f32>(0.0, 0.5 * shown.tall, 0.0), frame.eye.xyz);
    // What is but a few pixels tall thins out, and what is left is larger.
    shown.tall_px = shown.tall / (shown.distance_m * frame.screen.z);
    let kept = clamp(shown.tall_px / 16.0, FEWEST, 1.0);
    shown.larger = pow(kept, -0.3);
    shown.lot = random3(vec2<i32>(i32(plant.site), 5), 91u).x;
    let reach_m = brush.shape.y;
    let stays = clamp((kept - shown.lot) / (0.2 * kept), 0.0, 1.0) * (1.0 - smoothstep(0.8, 1.0, shown.distance_m / reach_m));
    shown.left = select(stays, 0.0, shown.distance_m > reach_m);
    return shown;
}

@compute @workgroup_size(64)
fn sift(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let chunk = chunks[group.x];
    if local >= chunk.y {
        return;
    }
    let index = chunk.x + local;
    let plant = grown[index];
    let shown = shown_of(plant);
    let reach_m = brush.species[plant.make & 255u].z * plant.size * shown.larger * 1.8;
    if (shown.left > 0.01) & ((brush.counts.y == 0u) | is_seen(shown.root, reach_m)) {
        let number = atomicAdd(&sifted[0], 1u);
        atomicStore(&sifted[1u + number], index);
        if number % 64u == 0u {
            atomicAdd(&sifted_groups[0], 1u);
        }
    }
}

// Blocks up to which plants take them at their own levels; the rest is for those that found none, at the coarsest level.
fn main_room() -> u32 {
    return brush.counts.w - brush.counts.w / 4u;
}

fn blocks_of(list: u32) -> u32 {
    return (lists.list[list].rows.x + BLOCK - 1u) / BLOCK;
}

// Writes down whose some blocks are, of which there are fewer than `end`; whether all of them are.
fn claim(first: u32, blocks: u32, end: u32, number: u32) -> bool {
    let is_room = first + blocks <= end;
    for (var block = first; block < min(first + blocks, end); block++) {
        owners_out[block] = select(NOBODY, number, is_room);
    }
    return is_room;
}

// Finds room for the rows of stand `number`: the level at which it is drawn, LEVELS if there is none, and the first of its blocks.
fn room(species: u32, finest: u32, number: u32) -> vec2<u32> {
    let blocks = blocks_of(species * LEVELS + finest);
    let first = atomicAdd(&tally.blocks, blocks);
    if claim(first, blocks, main_room(), number) {
        return vec2<u32>(finest, first);
    }
    let few = blocks_of(species * LEVELS + LEVELS - 1u);
    let spare = main_room() + atomicAdd(&tally.spare, few);
    return vec2<u32>(select(LEVELS, LEVELS - 1u, claim(spare, few, brush.counts.w, number)), spare);
}

@compute @workgroup_size(64)
fn stand(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= min(candidates[0], brush.counts.z) {
        return;
    }
    let index = candidates[1u + id.x];
    let plant = grown[index];
    let species = plant.make & 255u;
    let nature = brush.species[species];
    let height = nature.x * plant.size;
    let shown = shown_of(plant);
    let root = shown.root;
    let distance_m = shown.distance_m;

    let fall = (broken[plant.site >> 2u] >> (8u * (plant.site & 3u))) & 255u;
    let goal = fallen(pressure_at(root, 0.5 * height), fall);
    var feels = felt[index];
    if brush.counts.x - feels.frame > 1u {
        feels.pressure = vec4<f32>(goal, 0.0, 0.0);
    } else {
        feels.pressure = followed(feels.pressure, goal, nature.y, brush.shape.x);
    }
    feels.frame = select(feels.frame, brush.counts.x, brush.shape.x > 0.0);
    felt[index] = feels;

    var lean = lean_of_field(plant.at, 0.0);
    let tilt = length(lean);
    lean *= min(1.0, 1.5 / max(tilt, 1e-5));

    let make = (plant.make >> 8u) % VARIANTS + select(0u, VARIANTS, fall != 0u);
    let shown_size = plant.size * shown.left * shown.larger;
    var spheres = 0u;
    let every = u32(frame.clouds.w + none_of(height));
    for (var s = 0u; s < every; s++) {
        let sphere = frame.spheres[s];
        spheres |= select(0u, 1u << s, distance(sphere.xyz, root) < sphere.w + nature.z * shown_size);
    }

    var out: Stand;
    out.root = vec4<f32>(root, shown_size);
    let lit = root + vec3<f32>(0.0, 0.6 * height, 0.0);
    out.lean = vec4<f32>(lean, cloud_light(plant.at) * sun_visible(lit), plant.heading);
    let kind_number = kind_at(plant.at);
    let kind = kinds.list[kind_number];
    out.feels = vec4<f32>(feels.pressure.xy, f32(make + 2u * VARIANTS * kind_number), f32(spheres));
    out.about = vec4<f32>(height, random3(vec2<i32>(i32(plant.site), 9), 17u).x, distance_m, plant.size);
    let up = ground_normal(plant.at);
    let view = normalize(root - frame.eye.xyz);
    let tint = grass_tint(plant.at);
    let afar = sward_color(root, up, kind, tint, lean, view, out.lean.z);
    out.sward = vec4<f32>(afar, bare_between(distance_m, kind, view, up) * grass_share(plant.at));
    out.air = air_before(root + vec3<f32>(0.0, 0.5 * height, 0.0));

    // Not all of those of a height change at once.
    let fine_px = shown.tall_px / (brush.shape.w * (0.85 + 0.3 * shown.lot));
    let finest = select(select(select(3u, 2u, fine_px > 26.0), 1u, fine_px > 90.0), 0u, fine_px > 300.0);
    let place = room(species, finest, id.x);
    if place.x == LEVELS {
        return;
    }
    let list = species * LEVELS + place.x;
    out.tint = vec4<f32>(tint, f32(list));
    out.up = vec4<f32>(up, f32(place.y));
    stands_out[id.x] = out;
    listed[lists.list[list].which.y + atomicAdd(&tally.drawn[list], 1u)] = place.y;
}

// Indirect draws: as many instances as hold the listed plants; and as many workgroups as their rows take.
@compute @workgroup_size(64)
fn finish(@builtin(local_invocation_index) list: u32) {
    let held = lists.list[list].rows.y;
    brush_draws[list * 5u + 1u] = (atomicLoad(&tally.drawn[list]) + held - 1u) / max(held, 1u);
    let spare = min(atomicLoad(&tally.spare), brush.counts.w - main_room());
    let blocks = min(atomicLoad(&tally.blocks), main_room()) + spare;
    let groups = (blocks + BLOCKS_OF_GROUP - 1u) / BLOCKS_OF_GROUP;
    if list < groups * BLOCKS_OF_GROUP - blocks {
        owners_out[blocks + list] = NOBODY;
    }
    if list < 3u {
        ribbon_groups[list] = select(1u, groups, list == 0u);
    }
}
