// Underbrush: culling, force and level of detail of each plant.

import package::constants::{
    AIR_KG_PER_M3, BLOCK_ROWS, CHUNK, CLOSE_PX, DRAW_WORDS, ENLARGEMENT_EXPONENT, FALL_PA, FULLY_CLOSE, MIN_KEPT_FRACTION,
    SPARE_DIVISOR, TAU, UNDERBRUSH_LEVELS, UNDERBRUSH_LISTS, VARIANTS, WORKGROUP_SIZE,
};
import package::inputs::bend_atlas::lean_of_field;
import package::inputs::depth_pyramid::is_sphere_hidden;
import package::inputs::frame::{frame, runtime_zero};
import package::inputs::frustum::is_seen;
import package::inputs::grass_kinds::{kind_at, kinds};
import package::inputs::random::random3;
import package::inputs::shadows::sun_visible;
import package::inputs::sward_shade::shade_at;
import package::inputs::wind::{gust_at, near_ground_fraction, resolved_at};
import package::land_and_sky::clouds::cloud_light;
import package::land_and_sky::grass_color::grass_tint;
import package::land_and_sky::ground::{grass_fraction, ground_height, ground_normal};
import package::land_and_sky::haze::air_before;
import package::land_and_sky::snow::with_snow;
import package::land_and_sky::sward::{bare_between, sward_color};
import package::plants::force_field::{forces_at, sheltered};
import package::plants::near_leaf::{fs_close, vs_close};
import package::plants::ribbons::{fs, ribbons, vs};
import package::plants::visible_plant::{FREE_BLOCK, lists, VisiblePlant};
import package::uniforms::UnderbrushFrame;

// A plant of the scene.
struct UnderbrushPlant {
    // X and Z (m).
    at_m: vec2<f32>,
    // Size relative to the species.
    size: f32,
    // Species in the low byte, variant in the next.
    species_and_variant: u32,
    heading_rad: f32,
    // Number of its site.
    site: u32,
}

// Response of a plant to the force field (Endo et al. 2003, section 4.3).
struct ForceResponse {
    // Pressure, X and Z (Pa).
    pressure_pa: vec2<f32>,
    // Its rate of change (Pa/s).
    rate_pa_per_s: vec2<f32>,
    // Number of the frame in which the plant was last in view; counts frames in which time advances.
    @size(16) frame: u32,
}

struct UnderbrushCounters {
    // Plants of each list.
    drawn: array<atomic<u32>, UNDERBRUSH_LISTS>,
    // Blocks of rows requested at the levels of the plants.
    blocks: atomic<u32>,
    // Blocks requested at the coarsest level for lack of room.
    spare: atomic<u32>,
}

@group(1) @binding(0) var<uniform> brush: UnderbrushFrame;
@group(1) @binding(1) var<storage, read> brush_plants: array<UnderbrushPlant>;
@group(1) @binding(2) var<storage, read> chunks: array<vec2<u32>>;
@group(1) @binding(3) var<storage, read_write> responses: array<ForceResponse>;
@group(1) @binding(4) var<storage, read_write> visible_out: array<VisiblePlant>;
@group(1) @binding(5) var<storage, read_write> counters: UnderbrushCounters;
@group(1) @binding(6) var<storage, read_write> listed: array<u32>;
// Direction in which the plant of each site fell, a byte each.
@group(1) @binding(7) var<storage, read> broken: array<u32>;
@group(1) @binding(8) var<storage, read_write> brush_draws: array<u32>;
// Number of plants that may be in view, and their indices.
@group(1) @binding(17) var<storage, read_write> sifted: array<atomic<u32>>;
// Number of their workgroups, for an indirect dispatch.
@group(1) @binding(18) var<storage, read_write> sifted_groups: array<atomic<u32>, 3>;
@group(1) @binding(19) var<storage, read> candidates: array<u32>;
// The plant of each block of rows.
@group(1) @binding(20) var<storage, read_write> owners_out: array<u32>;
// Number of workgroups of `ribbons`, for an indirect dispatch.
@group(1) @binding(22) var<storage, read_write> ribbon_groups: array<u32, 3>;

const GROUP_BLOCKS: u32 = WORKGROUP_SIZE / BLOCK_ROWS;

// Force on a silhouette (Pa, X and Z) at a height above the root: from the force field, and beyond it from the wind alone.
fn pressure_at(root: vec3<f32>, above_m: f32) -> vec2<f32> {
    let force = forces_at(root.xz, above_m);
    let wind = sheltered(resolved_at(root, above_m).xz, force.xy);
    // With the gust, and shelter among the plants.
    let blown = (wind + gust_at(root.xz)) * near_ground_fraction(above_m);
    return blown * (0.5 * AIR_KG_PER_M3 * length(blown)) + force.zw;
}

// Critically damped response of a value to a target, in closed form. Twin of `Following` in shared/src/plant/underbrush/constraint.rs.
fn followed(state: ForceResponse, goal: vec2<f32>, settle_secs: f32, dt: f32) -> ForceResponse {
    let taus = dt / settle_secs;
    let decay = exp(-taus);
    let off = state.pressure_pa - goal;
    let value = goal + off * ((1.0 + taus) * decay) + state.rate_pa_per_s * (dt * decay);
    return ForceResponse(value, off * (-taus / settle_secs * decay) + state.rate_pa_per_s * ((1.0 - taus) * decay), state.frame);
}

// Pressure (Pa) on a plant under the wind's `pressure`. `fall` is the direction in which the plant fell, in 255ths of a turn, or 0 if it
// stands. A constant pressure keeps a fallen plant bent. It lies at a fifth of its height, where the quarter-power law leaves 0.45 of the
// wind's pressure.
fn fallen(pressure: vec2<f32>, fall: u32) -> vec2<f32> {
    let heading = f32(fall) * (TAU / 255.0);
    return select(pressure, 0.45 * pressure + FALL_PA * vec2<f32>(cos(heading), sin(heading)), fall != 0u);
}

struct DisplaySize {
    // Root of the plant (m).
    root: vec3<f32>,
    // Height of its box (m).
    tall: f32,
    distance_m: f32,
    // Height on the screen (px).
    tall_px: f32,
    // Random number 0..1 of the plant.
    lot: f32,
    // Enlargement over its true size, where plants thin out.
    larger: f32,
    // Factor on its size where plants end or thin out: 0 gone, 1 full.
    left: f32,
}

fn display_size(plant: UnderbrushPlant) -> DisplaySize {
    let nature = brush.species[plant.species_and_variant & 255u];
    var shown: DisplaySize;
    shown.root = vec3<f32>(plant.at_m.x, ground_height(plant.at_m), plant.at_m.y);
    shown.tall = max(nature.height_m, 0.5 * nature.reach_m) * plant.size;
    shown.distance_m = distance(shown.root + vec3<f32>(0.0, 0.5 * shown.tall, 0.0), frame.eye_m);
    // Plants of a few pixels thin out, and the rest are larger.
    shown.tall_px = shown.tall / (shown.distance_m * frame.pixel_rad);
    let kept = clamp(shown.tall_px / 16.0, MIN_KEPT_FRACTION, 1.0);
    shown.larger = pow(kept, ENLARGEMENT_EXPONENT);
    shown.lot = random3(vec2<i32>(i32(plant.site), 5), 91u).x;
    let reach_m = brush.reach_m;
    let stays = clamp((kept - shown.lot) / (0.2 * kept), 0.0, 1.0) * (1.0 - smoothstep(0.8, 1.0, shown.distance_m / reach_m));
    shown.left = select(stays, 0.0, shown.distance_m > reach_m);
    return shown;
}

@compute @workgroup_size(CHUNK)
fn sift(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let chunk = chunks[group.x];
    if local >= chunk.y {
        return;
    }
    let index = chunk.x + local;
    let plant = brush_plants[index];
    let shown = display_size(plant);
    let reach_m = brush.species[plant.species_and_variant & 255u].reach_m * plant.size * shown.larger * 1.8;
    let may_show = (shown.left > 0.01) & ((brush.culls == 0u) | is_seen(shown.root, reach_m));
    if may_show && !is_sphere_hidden(shown.root, reach_m) {
        let number = atomicAdd(&sifted[0], 1u);
        atomicStore(&sifted[1u + number], index);
        if number % CHUNK == 0u {
            atomicAdd(&sifted_groups[0], 1u);
        }
    }
}

// Blocks for plants at their own levels; the rest is for plants that found none, at the coarsest level.
fn main_room() -> u32 {
    return brush.block_limit - brush.block_limit / SPARE_DIVISOR;
}

fn blocks_of(list: u32) -> u32 {
    return (lists.list[list].rows + BLOCK_ROWS - 1u) / BLOCK_ROWS;
}

// Claims blocks below `end` for a plant; returns whether all of them were free.
fn claim(first: u32, blocks: u32, end: u32, number: u32) -> bool {
    let is_room = first + blocks <= end;
    for (var block = first; block < min(first + blocks, end); block++) {
        owners_out[block] = select(FREE_BLOCK, number, is_room);
    }
    return is_room;
}

// Allocates the rows of plant `number`: the level at which it is drawn (`UNDERBRUSH_LEVELS` if there is no room) and its first block.
fn room(species: u32, finest: u32, number: u32) -> vec2<u32> {
    let blocks = blocks_of(species * UNDERBRUSH_LEVELS + finest);
    let first = atomicAdd(&counters.blocks, blocks);
    if claim(first, blocks, main_room(), number) {
        return vec2<u32>(finest, first);
    }
    let few = blocks_of(species * UNDERBRUSH_LEVELS + UNDERBRUSH_LEVELS - 1u);
    let spare = main_room() + atomicAdd(&counters.spare, few);
    return vec2<u32>(select(UNDERBRUSH_LEVELS, UNDERBRUSH_LEVELS - 1u, claim(spare, few, brush.block_limit, number)), spare);
}

// Pressure (Pa) that a plant has followed; its response is kept for the next frame. `fall` is as in `fallen`.
fn followed_pressure(index: u32, root: vec3<f32>, height: f32, fall: u32, settle_secs: f32) -> vec2<f32> {
    let goal = fallen(pressure_at(root, 0.5 * height), fall);
    var response = responses[index];
    if brush.frame_number - response.frame > 1u {
        response = ForceResponse(goal, vec2<f32>(0.0), response.frame);
    } else {
        response = followed(response, goal, settle_secs, brush.step_secs);
    }
    response.frame = select(response.frame, brush.frame_number, brush.step_secs > 0.0);
    responses[index] = response;
    return response.pressure_pa;
}

// Bit mask of the interaction spheres that a plant may touch.
fn spheres_at(root: vec3<f32>, reach_m: f32) -> u32 {
    var spheres = 0u;
    let every = frame.sphere_count + u32(runtime_zero(reach_m));
    for (var s = 0u; s < every; s++) {
        let sphere = frame.spheres[s];
        spheres |= select(0u, 1u << s, distance(sphere.centre_m, root) < sphere.radius_m + reach_m);
    }
    return spheres;
}

// Posture and light of a plant; without its force, and without its level of detail and its rows.
fn standing(plant: UnderbrushPlant, shown: DisplaySize, height: f32) -> VisiblePlant {
    var out: VisiblePlant;
    let root = shown.root;
    var lean = lean_of_field(plant.at_m, 0.0);
    let tilt = length(lean);
    lean *= min(1.0, 1.5 / max(tilt, 1e-5));
    out.root_m = root;
    out.shown_size = plant.size * shown.left * shown.larger;
    let lit = root + vec3<f32>(0.0, 0.6 * height, 0.0);
    out.lean_rad = lean;
    out.sunlight = cloud_light(plant.at_m) * sun_visible(lit);
    out.heading_rad = plant.heading_rad;
    out.height_m = height;
    out.hue = random3(vec2<i32>(i32(plant.site), 9), 17u).x;
    out.distance_m = shown.distance_m;
    out.size = plant.size;
    out.normal = ground_normal(plant.at_m);
    out.tint = grass_tint(plant.at_m);
    let kind_number = kind_at(plant.at_m);
    let kind = kinds.list[kind_number];
    let variant = (plant.species_and_variant >> 8u) % VARIANTS;
    out.variant_and_kind = variant + 2u * VARIANTS * kind_number;
    let view = normalize(root - frame.eye_m);
    let shade = shade_at(plant.at_m);
    let grass = sward_color(root, out.normal, kind, out.tint, lean, view, out.sunlight, shade);
    out.grass_rgb = with_snow(grass, root, out.normal, kind, view, out.sunlight, shade);
    out.grass_fraction = bare_between(shown.distance_m, kind, view, out.normal) * grass_fraction(plant.at_m);
    out.air = air_before(root + vec3<f32>(0.0, 0.5 * height, 0.0));
    return out;
}

// Height of a plant (px) that its level of detail depends on. Plants of one height change level at different distances.
fn fine_px(shown: DisplaySize) -> f32 {
    return shown.tall_px / (brush.coarseness * (0.85 + 0.3 * shown.lot));
}

// Finest level of detail of a plant of that height.
fn finest_level(fine_px: f32) -> u32 {
    return select(select(select(3u, 2u, fine_px > 26.0), 1u, fine_px > 90.0), 0u, fine_px > CLOSE_PX);
}

// Closeness of a plant of that height, 0 where it changes to the finest level.
fn closeness(fine_px: f32) -> u32 {
    return u32(255.0 * smoothstep(brush.close_px, FULLY_CLOSE * brush.close_px, fine_px) + 0.5);
}

@compute @workgroup_size(CHUNK)
fn stand(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= min(candidates[0], brush.plant_limit) {
        return;
    }
    let index = candidates[1u + id.x];
    let plant = brush_plants[index];
    let species = plant.species_and_variant & 255u;
    let nature = brush.species[species];
    let height = nature.height_m * plant.size;
    let shown = display_size(plant);
    let fall = (broken[plant.site >> 2u] >> (8u * (plant.site & 3u))) & 255u;
    let pressure = followed_pressure(index, shown.root, height, fall, nature.settle_secs);

    var out = standing(plant, shown, height);
    out.pressure_pa = pressure;
    out.variant_and_kind += select(0u, VARIANTS, fall != 0u);
    out.spheres = spheres_at(shown.root, nature.reach_m * out.shown_size);
    let tall_px = fine_px(shown);
    let place = room(species, finest_level(tall_px), id.x);
    if place.x == UNDERBRUSH_LEVELS {
        return;
    }
    let list = species * UNDERBRUSH_LEVELS + place.x;
    out.list = list | (select(0u, closeness(tall_px), place.x == 0u) << 24u);
    out.first_block = place.y;
    visible_out[id.x] = out;
    listed[lists.list[list].first_listed + atomicAdd(&counters.drawn[list], 1u)] = place.y;
}

// Arguments of the indirect draws and of the dispatch of `ribbons`.
@compute @workgroup_size(UNDERBRUSH_LISTS)
fn finish(@builtin(local_invocation_index) list: u32) {
    let held = lists.list[list].instance_plants;
    brush_draws[list * DRAW_WORDS + 1u] = (atomicLoad(&counters.drawn[list]) + held - 1u) / max(held, 1u);
    let spare = min(atomicLoad(&counters.spare), brush.block_limit - main_room());
    let blocks = min(atomicLoad(&counters.blocks), main_room()) + spare;
    let groups = (blocks + GROUP_BLOCKS - 1u) / GROUP_BLOCKS;
    if list < groups * GROUP_BLOCKS - blocks {
        owners_out[blocks + list] = FREE_BLOCK;
    }
    if list < 3u {
        ribbon_groups[list] = select(1u, groups, list == 0u);
    }
}
