// Underbrush as ribbons: the components of visible plants, bent by precomputed tables of postures (Endo et al. 2003, section 4.2),
// widened and lit. One invocation computes both borders of a row, which are then drawn.

import package::constants::{
    BLOCK_ROWS, DROP_M_PER_S, GRAVITY_M_PER_S2, MIDDLE_LOAD, PETAL, STALK, TAU, UNIT_STEPS, VARIANTS, WIDTH_UNIT_M, WORKGROUP_SIZE,
};
import package::gpu::vectors::{arc_cosine, square, unit_or};
import package::inputs::frame::frame;
import package::inputs::grass_kinds::kinds;
import package::inputs::lamps::lamps_on;
import package::inputs::random::random3;
import package::inputs::sward_shade::{shade_at, sun_over_grass};
import package::land_and_sky::grass_light::{even_depth, grass_lamps, grass_light, sun_in_plants};
import package::land_and_sky::ground::grass_fraction;
import package::land_and_sky::sky_light::ambient;
import package::plants::blade::{aside_of, meets_spheres};
import package::plants::leaf_fold::fold;
import package::plants::visible_plant::{closeness_of, FREE_BLOCK, kind_around, list_of, lists, variant_of, VisiblePlant};
import package::uniforms::{BrushList, DrawnList};

// Colour of a part at a height in the grass that hides it (1 at the mean height of the grass).
fn among_grass(color: vec3<f32>, plant: VisiblePlant, up: f32) -> vec3<f32> {
    return mix(color, plant.grass_rgb, plant.grass_fraction * (1.0 - smoothstep(0.3, 1.1, up)));
}

// A row of a ribbon.
struct Row {
    // Half-width (`WIDTH_UNIT_M`) in the low half, material in the high half.
    width_and_material: u32,
    // Square root of the linear colour, a byte for each of red, green and blue.
    rgb: u32,
    // Number of its component in the low half, number of steps below it there in the high half.
    limb_and_steps: u32,
    // `FIRST_ROW` and `LAST_ROW`, kind of veins in bits 2 and 3, their number in bits 4 to 7, and fraction of its ribbon in the high half.
    close: u32,
    // For a petal: distance from the tip of the stalk (m).
    petal_m: f32,
    // Cosine and sine of the petal's rotation around the stalk.
    petal_turn_cosine: f32,
    petal_turn_sine: f32,
    // Sine of its angle from the stalk.
    petal_sine: f32,
}

// A component of a plant of size 1. Its host is the component that it is attached to.
struct Limb {
    // Cosine and sine of its angle from its host.
    angle: vec2<f32>,
    // Cosine and sine of its rotation around the host.
    turn: vec2<f32>,
    // Load per force per mass (s²/m).
    load_s2_per_m: f32,
    // Load per pressure (1/Pa).
    load_per_pa: f32,
    // Length (m).
    length_m: f32,
    // Position on its host (steps of the host).
    host_steps: f32,
    // First step of its table.
    first_step: u32,
    // Number of its steps.
    steps: u32,
    // Number of its host.
    host: u32,
    // Number of its hosts, down to the ground.
    depth: u32,
    // Initial speed of its tip when a drop of rain strikes it (m/s).
    drop_m_per_s: f32,
    // Time to the maximum deflection (s).
    drop_secs: f32,
    // Area that drops strike (m²); 0 if it does not tremble.
    drop_m2: f32,
    unused: f32,
}

@group(1) @binding(10) var<storage, read> visible_plants: array<VisiblePlant>;
@group(1) @binding(11) var<storage, read> shown: array<u32>;
@group(1) @binding(12) var<storage, read> counted: array<u32>;
@group(1) @binding(13) var<storage, read> steps: array<vec2<f32>>;
@group(1) @binding(14) var<storage, read> rows: array<Row>;
@group(1) @binding(16) var<storage, read> limbs: array<Limb>;
@group(1) @binding(21) var<storage, read> owners: array<u32>;
@group(1) @binding(23) var<storage, read_write> borders_out: array<Border>;
@group(1) @binding(24) var<storage, read> borders: array<Border>;
@group(1) @binding(25) var<uniform> drawn: DrawnList;

// Whether leaves tremble in the rain. Fixed when a pipeline is made.
override trembles: bool = true;
// Whether near plants are drawn as curves. Fixed when a pipeline is made.
override curves: bool = false;

// Maximum dip of a component relative to its length; at that point its own weight has bent it completely.
const FARTHEST_DIP: f32 = 0.25;

// Border of a row to be drawn.
struct Border {
    // Position (m).
    position_m: vec3<f32>,
    // Coordinate across its ribbon, as in `Ribbon`.
    across: f32,
    color: vec3<f32>,
    // As in `Row`, with the closeness in bits 8 to 15.
    close: u32,
}

struct Ribbon {
    @builtin(position) position: vec4<f32>,
    @location(0) color: vec3<f32>,
    // Coordinate across: -1 at the left border, 1 at the right one; beyond these where the ribbon has no fold.
    @location(1) @interpolate(linear) across: f32,
}

// Position on a component, from the root (m), and its axes.
struct Bent {
    at: vec3<f32>,
    along: vec3<f32>,
    side: vec3<f32>,
}

// Axes of an upright plant, turned by its heading and tipped by the lean of the bend field.
fn ground_frame(plant: VisiblePlant) -> Bent {
    let side = vec3<f32>(sin(plant.heading_rad), 0.0, -cos(plant.heading_rad));
    let angle = length(plant.lean_rad);
    let axis = vec3<f32>(plant.lean_rad.y, 0.0, -plant.lean_rad.x) / max(angle, 1e-9);
    let up = vec3<f32>(0.0, cos(angle), 0.0) + cross(axis, vec3<f32>(0.0, 1.0, 0.0)) * sin(angle);
    let across = side * cos(angle) + cross(axis, side) * sin(angle) + axis * (dot(axis, side) * (1.0 - cos(angle)));
    return Bent(vec3<f32>(0.0), up, across);
}

// Keeps the end of a step above the ground: a direction that would end below it is raised until it ends on it; one straight down is laid
// towards `front`.
fn above_ground(direction: vec3<f32>, front: vec3<f32>, normal: vec3<f32>, height: f32) -> vec3<f32> {
    let fall = dot(direction, normal);
    let up = max(fall, -max(height, 0.0));
    let level = unit_or(square(direction + front * 1e-4, normal), vec3<f32>(0.0));
    return select(direction, normalize(normal * up + level * sqrt(max(1.0 - up * up, 0.0))), up > fall);
}

// Direction of a step from `below` that passes outside the spheres, as for links of blades; where the nearest one leads through the ground,
// the one above the spheres.
fn passing(along: vec3<f32>, below: vec3<f32>, length_m: f32, plant: VisiblePlant, normal: vec3<f32>) -> vec3<f32> {
    var way = along;
    let steepest = -max(dot(below, normal), 0.0) / length_m;
    for (var round = 0; round < 2; round++) {
        for (var left = plant.spheres; left != 0u; left &= left - 1u) {
            let sphere = frame.spheres[firstTrailingBit(left)];
            let centre = sphere.centre_m - plant.root_m;
            let nearest = aside_of(way, below, length_m, centre, sphere.radius_m);
            let above = aside_of(normalize(way + normal), below, length_m, centre, sphere.radius_m);
            way = select(nearest, above, any(nearest != way) && dot(nearest, normal) < steepest);
        }
    }
    return way;
}

// Position on a component after `so_many` steps from its host, and axes of step `last`. Twin of `posed` in
// shared/src/plant/underbrush/plant.rs, with contacts with spheres.
fn bent(host: Bent, limb: Limb, so_many: f32, last: u32, plant: VisiblePlant, normal: vec3<f32>, list: BrushList) -> Bent {
    let outward = host.side * limb.turn.x - cross(host.along, host.side) * limb.turn.y;
    let axis = normalize(host.along * limb.angle.x + outward * limb.angle.y);
    let across = cross(outward, host.along);
    let side = unit_or(square(cross(axis, vec3<f32>(0.0, 1.0, 0.0)) + across * 1e-3, axis), across);

    let pressure = plant.pressure_pa * limb.load_per_pa;
    let load = vec3<f32>(pressure.x, -GRAVITY_M_PER_S2 * limb.load_s2_per_m * plant.size, pressure.y);
    let size = length(load);
    let down = load / max(size, 1e-30);
    let away = cross(axis, side);
    let towards = unit_or(square(square(down, axis) + away * 1e-6, axis), away);
    let around = cross(axis, towards);

    let nodes = vec2<f32>(list.nodes - 1u);
    let angle = arc_cosine(clamp(-dot(down, axis), -1.0, 1.0));
    let place = vec2<f32>(sqrt(angle * 2.0 / TAU), 1.0 - MIDDLE_LOAD / (size + MIDDLE_LOAD)) * nodes;
    let is_nearest = list.is_nearest == 1u;
    let node = min(vec2<u32>(place + select(0.0, 0.5, is_nearest)), list.nodes - select(2u, 1u, is_nearest));
    let by = place - vec2<f32>(node);
    let to_load = limb.steps;
    let to_angle = list.nodes.y * to_load;
    let first = list.first_step + limb.first_step + node.x * to_angle + node.y * to_load;

    let length_m = limb.length_m * plant.shown_size;
    var now = Bent(host.at, axis, side);
    var tangent = vec3<f32>(0.0);
    for (var i = 0u; i <= last; i++) {
        let at = first + i;
        var step = steps[at];
        if !is_nearest {
            let heavier = mix(steps[at + to_angle], steps[at + to_angle + to_load], by.y);
            step = mix(mix(step, steps[at + to_load], by.y), heavier, by.x);
        }
        let step_m = step.y * length_m;
        let free = axis * cos(step.x) + towards * sin(step.x);
        let turned = around * dot(side, around) + (towards * cos(step.x) - axis * sin(step.x)) * dot(side, towards);
        let height = dot(now.at, normal) / step_m;
        now.along = above_ground(free, cross(free, turned), normal, height);
        if meets_spheres && plant.spheres != 0u {
            // Steps after the first contact with a sphere continue in its direction.
            let own = select(now.along, tangent, any(tangent != vec3<f32>(0.0)));
            let way = passing(own, now.at, step_m, plant, normal);
            now.along = above_ground(way, cross(way, turned), normal, height);
            tangent = select(tangent, now.along, any(way != own));
        }
        now.side = unit_or(square(turned, now.along), turned);
        now.at += now.along * (step_m * clamp(so_many - f32(i), 0.0, 1.0));
    }
    return now;
}

fn first_limb(plant: VisiblePlant, list: BrushList) -> u32 {
    return list.first_limb + variant_of(plant) * list.limbs;
}

fn limb_of(plant: VisiblePlant, row: Row, list: BrushList) -> Limb {
    return limbs[first_limb(plant, list) + (row.limb_and_steps & 0xffffu)];
}

fn row_of(plant: VisiblePlant, number: u32, list: BrushList) -> Row {
    return rows[list.first_row + plant.variant_and_kind % VARIANTS * list.rows + number];
}

// Position of a row of a plant on ground with that normal: bends the chain of components from the root on.
fn bent_row(plant: VisiblePlant, row: Row, normal: vec3<f32>, list: BrushList) -> Bent {
    let limb_0 = first_limb(plant, list);
    let own = limb_of(plant, row, list);
    var now = ground_frame(plant);
    for (var above = own.depth; above > 0u; above--) {
        // Host at that depth of the chain.
        var next = own;
        for (var i = 1u; i < above; i++) {
            next = limbs[limb_0 + next.host];
        }
        let limb = limbs[limb_0 + next.host];
        now = bent(now, limb, next.host_steps, min(u32(next.host_steps), limb.steps - 1u), plant, normal, list);
    }
    let so_many = row.limb_and_steps >> 16u;
    now = bent(now, own, f32(so_many), max(so_many, 1u) - 1u, plant, normal, list);
    if row.width_and_material >> 16u == PETAL {
        let other = cross(now.along, now.side);
        let outward = now.side * row.petal_turn_cosine + other * row.petal_turn_sine;
        let along = now.along * sqrt(1.0 - row.petal_sine * row.petal_sine) + outward * row.petal_sine;
        now = Bent(now.at + along * (row.petal_m * plant.shown_size), along, other * row.petal_turn_cosine - now.side * row.petal_turn_sine);
    }
    return now;
}

// Dip of the tip of a component by drops of rain (m), if they strike it straight on. `speed` and `settle` are those of `Struck` in
// shared/src/plant/underbrush/drops.rs, `per_s` the rate of drops, `number` identifies the component. At most one drop strikes in each span
// of `settle`. Where more than one falls in every other span, strikes are scaled by the square root of their number and the rest press
// steadily: the mean equals that of single drops, and the standard deviation is at least 0.84 of theirs.
fn dip_m(speed: f32, settle: f32, per_s: f32, number: vec2<u32>, secs: f32) -> f32 {
    let drops = per_s * settle;
    let chance = min(drops, 0.5);
    let strength = sqrt(drops / chance);
    // The mean of `bow` over the component.
    var dip = 0.375 * (drops - chance * strength);
    let now = secs / settle;
    let span = i32(floor(now));
    for (var i = 0; i < 8; i++) {
        let lot = random3(vec2<i32>(span - i, i32(number.x)), number.y);
        let since = now - (f32(span - i) + lot.x);
        if since > 0.0 && lot.y < chance {
            dip += strength * bow(lot.z) * since * exp(-since);
        }
    }
    return speed * settle * dip;
}

// Deflection of a cantilever with a force at its tip, normalised to 1 at the tip.
fn bow(fraction: f32) -> f32 {
    return fraction * fraction * (1.5 - 0.5 * fraction);
}

// Direction of the curve of a near plant at a row whose lower section has the direction `along`: the mean of those of both sections.
fn smoothed(along: vec3<f32>, plant: VisiblePlant, row: Row, own: Limb, list: BrushList) -> vec3<f32> {
    let is_within = (row.limb_and_steps >> 16u) < own.steps;
    if !curves || closeness_of(plant) == 0u || !is_within || row.width_and_material >> 16u == PETAL {
        return along;
    }
    var above = row;
    above.limb_and_steps += 1u << 16u;
    let ahead = bent_row(plant, above, plant.normal, list).along;
    return unit_or(along + ahead * (f32(closeness_of(plant)) / 255.0), along);
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn ribbons(@builtin(global_invocation_id) id: vec3<u32>) {
    let owner = owners[id.x / BLOCK_ROWS];
    if owner == FREE_BLOCK {
        return;
    }
    let plant = visible_plants[owner];
    let list = lists.list[list_of(plant)];
    let number = id.x - plant.first_block * BLOCK_ROWS;
    if number >= list.rows {
        return;
    }
    let row = row_of(plant, number, list);
    let material = row.width_and_material >> 16u;
    let size = plant.shown_size;
    let normal_up = plant.normal;
    let bent = bent_row(plant, row, normal_up, list);
    let own = limb_of(plant, row, list);
    let along = smoothed(bent.along, plant, row, own, list);
    var p = plant.root_m + bent.at;
    if trembles && list.drops_per_m2_per_s * own.drop_m2 > 0.0 {
        let number = vec2<u32>(u32(plant.hue * UNIT_STEPS), row.limb_and_steps & 0xffffu);
        // The larger the component, the less the mass of the drop counts.
        let speed = 1.0 / mix(1.0 / DROP_M_PER_S, 1.0 / own.drop_m_per_s, size * size * size);
        let dip = dip_m(speed, own.drop_secs * size, own.drop_m2 * size * size * list.drops_per_m2_per_s, number, frame.time_secs);
        // The leaf does not yield along its axis.
        let down = vec3<f32>(0.0, 1.0, 0.0) - along * along.y;
        p -= down * (min(dip, FARTHEST_DIP * own.length_m * size) * bow(f32(row.limb_and_steps >> 16u) / f32(own.steps)));
    }
    let view = normalize(p - frame.eye_m);
    let toward = cross(along, view);
    let facing_side = toward / max(length(toward), 1e-3);
    var side = bent.side;
    if material == STALK {
        side = facing_side;
    } else if material != PETAL {
        // A leaf seen edge on still shows part of its width.
        side = normalize(side + facing_side * (0.35 * sign(dot(facing_side, side) + 1e-4)));
    }
    let width = row.width_and_material & 0xffffu;
    let half = max(f32(width) * WIDTH_UNIT_M * size, select(0.0, 0.45 * plant.distance_m * frame.pixel_rad, width > 0u));
    let lit = Lit(p, along, side, half, view, material, row.rgb, row.close | (closeness_of(plant) << 8u));
    borders_out[2u * id.x] = lit_border(plant, lit, -1.0);
    borders_out[2u * id.x + 1u] = lit_border(plant, lit, 1.0);
}

// A row to be lit: position on its axis (m), axis, side, half width (m), view direction, material and colour, and `close` as in `Border`.
struct Lit {
    at: vec3<f32>,
    along: vec3<f32>,
    side: vec3<f32>,
    half: f32,
    view: vec3<f32>,
    material: u32,
    rgb: u32,
    close: u32,
}

// Left (-1) or right (1) border of a row.
fn lit_border(plant: VisiblePlant, row: Lit, across: f32) -> Border {
    let normal_up = plant.normal;
    var p = row.at + row.side * (across * row.half);
    p += normal_up * max(0.012 - dot(p - plant.root_m, normal_up), 0.0);
    var normal = normalize(cross(row.side, row.along));
    normal *= -sign(dot(normal, row.view) + 1e-5);
    let is_stalk = row.material == STALK;
    let rounded = normalize(normal * select(0.8, 0.55, is_stalk) + row.side * (across * select(0.25, 0.8, is_stalk)) + normal_up * 0.35);
    let root_color = unpack4x8unorm(row.rgb).rgb;
    var albedo = root_color * root_color;
    if row.material != PETAL {
        albedo *= plant.tint * mix(vec3<f32>(0.86, 0.98, 0.85), vec3<f32>(1.14, 1.03, 0.9), plant.hue);
    }
    let above = dot(p - plant.root_m, normal_up);
    let up = clamp(above / max(plant.height_m, 0.05), 0.0, 1.0);
    let deep = smoothstep(0.0, 0.6, plant.height_m);
    let occlusion = mix(mix(0.62, 0.30, deep), 1.0, smoothstep(0.0, 0.8, up));
    let around = kinds.list[kind_around(plant)];
    let over_grass = sun_over_grass(shade_at(p.xz), above, even_depth(around) * grass_fraction(plant.root_m.xz), around.height_m);
    let light = plant.sunlight * sun_in_plants(0.2 + up, plant.height_m) * over_grass;
    var color: vec3<f32>;
    if row.material == PETAL {
        let sun_facing = dot(normal, frame.toward_sun);
        let diffuse = clamp((abs(sun_facing) + 0.3) / 1.3, 0.0, 1.0);
        let through = 0.4 * max(dot(row.view, frame.toward_sun), 0.0) * clamp(0.6 - sun_facing, 0.0, 1.0);
        color = albedo * (frame.sun_rgb * light * (diffuse + through) * 0.8 + ambient(rounded) + lamps_on(p, rounded, 0.3));
    } else {
        color = grass_light(albedo, rounded, row.along, row.view, light, occlusion) + grass_lamps(albedo, rounded, row.along, row.view, p, up);
    }
    let seen = among_grass(color, plant, above / around.height_m) * plant.air.a + plant.air.rgb;
    let is_folded = !is_stalk & (row.material != PETAL);
    return Border(p, select(9.0, across, is_folded), seen, row.close);
}

@vertex
fn vs(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Ribbon {
    let list = lists.list[drawn.number];
    let number = instance * list.instance_plants + index / (2u * list.rows);
    var out: Ribbon;
    if number >= counted[drawn.number] {
        out.position = vec4<f32>(0.0, 0.0, 0.0, 1.0);
        return out;
    }
    let border = borders[2u * BLOCK_ROWS * shown[list.first_listed + number] + index % (2u * list.rows)];
    out.color = border.color;
    out.across = border.across;
    out.position = frame.projection_from_world * vec4<f32>(border.position_m, 1.0);
    return out;
}

@fragment
fn fs(ribbon: Ribbon) -> @location(0) vec4<f32> {
    // `across` is extrapolated on ribbons that reach behind the eye.
    let across = clamp(ribbon.across, -9.0, 9.0);
    return vec4<f32>(ribbon.color * select(fold(across), 1.0, abs(across) > 1.5), 1.0);
}
