// Underbrush as ribbons: the components of visible plants, bent by precomputed tables of postures (Endo et al. 2003, section 4.2),
// widened and lit. One invocation computes both borders of a row, which are then drawn.

import package::constants::{
    ARC_COSINE, BLOCK_ROWS, DROP_M_PER_S, GRAVITY_M_PER_S2, MIDDLE_LOAD, PETAL, STALK, TAU, UNIT_STEPS, VARIANTS, WIDTH_UNIT_M,
};
import package::inputs::frame::frame;
import package::inputs::grass_kinds::kinds;
import package::inputs::lamps::lamps_on;
import package::inputs::random::random3;
import package::land_and_sky::grass_light::{grass_lamps, grass_light, sun_in_grass};
import package::land_and_sky::sky_light::ambient;
import package::plants::blade::{aside_of, meets_spheres};
import package::plants::stand::{lists, NOBODY, Stand};
import package::uniforms::{BrushList, DrawnList};

// Colour of a part at a height in the grass that hides it (1 at the mean height of the grass).
fn among_grass(color: vec3<f32>, sward: vec4<f32>, up: f32) -> vec3<f32> {
    return mix(color, sward.rgb, sward.w * (1.0 - smoothstep(0.3, 1.1, up)));
}

// A row: half-width and material, colour, its component and the number of steps below it there, unused; for a petal, distance from the tip
// of the stalk (m), cosine and sine of its rotation around the stalk, and sine of its angle from the stalk.
struct Row {
    look: vec4<u32>,
    petal: vec4<f32>,
}

// A component: cosine and sine of its angle from its parent (host) and of its rotation around it; load per force per mass (s²/m) and per
// pressure (1/Pa), length (m), and attachment in steps of the host; first step of its table, number of steps, host, and depth in the chain
// of hosts; speed (m/s) and time constant (s) of its response to a drop of rain, area that drops strike (m²), unused.
struct Limb {
    turns: vec4<f32>,
    nature: vec4<f32>,
    table: vec4<u32>,
    struck: vec4<f32>,
}

@group(1) @binding(10) var<storage, read> stands: array<Stand>;
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

// Maximum dip of a component relative to its length; at that point its own weight has bent it completely.
const FARTHEST_DIP: f32 = 0.25;

// Border of a row to be drawn: position (m) and coordinate across its ribbon; colour, unused.
struct Border {
    place: vec4<f32>,
    color: vec4<f32>,
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

// Component of a vector perpendicular to a unit vector.
fn square(v: vec3<f32>, direction: vec3<f32>) -> vec3<f32> {
    return v - direction * dot(v, direction);
}

fn unit_or(v: vec3<f32>, other: vec3<f32>) -> vec3<f32> {
    let size = length(v);
    return select(other, v / max(size, 1e-30), size > 1e-30);
}

// Angle (rad) of a cosine, to 7e-5: Abramowitz & Stegun 4.4.45. Twin of `acos` in shared/src/plant/underbrush/posture.rs.
fn arc_cosine(cosine: f32) -> f32 {
    let size = abs(cosine);
    let angle = sqrt(max(1.0 - size, 0.0)) * (ARC_COSINE[0] + size * (ARC_COSINE[1] + size * (ARC_COSINE[2] + size * ARC_COSINE[3])));
    return select(angle, 0.5 * TAU - angle, cosine < 0.0);
}

// Axes of an upright plant, turned by its heading and tipped by the lean of the ground.
fn ground_frame(plant: Stand) -> Bent {
    let side = vec3<f32>(sin(plant.lean.w), 0.0, -cos(plant.lean.w));
    let angle = length(plant.lean.xy);
    let axis = vec3<f32>(plant.lean.y, 0.0, -plant.lean.x) / max(angle, 1e-9);
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
fn passing(along: vec3<f32>, below: vec3<f32>, length_m: f32, plant: Stand, normal: vec3<f32>) -> vec3<f32> {
    var way = along;
    let steepest = -max(dot(below, normal), 0.0) / length_m;
    for (var round = 0; round < 2; round++) {
        for (var left = u32(plant.feels.w); left != 0u; left &= left - 1u) {
            let sphere = frame.spheres[firstTrailingBit(left)];
            let centre = sphere.centre_m - plant.root.xyz;
            let nearest = aside_of(way, below, length_m, centre, sphere.radius_m);
            let above = aside_of(normalize(way + normal), below, length_m, centre, sphere.radius_m);
            way = select(nearest, above, any(nearest != way) && dot(nearest, normal) < steepest);
        }
    }
    return way;
}

// Position on a component after `so_many` steps from its host, and axes of step `last`. Twin of `posed` in
// shared/src/plant/underbrush/plant.rs, with contacts with spheres.
fn bent(host: Bent, limb: Limb, so_many: f32, last: u32, plant: Stand, normal: vec3<f32>, list: BrushList) -> Bent {
    let outward = host.side * limb.turns.z - cross(host.along, host.side) * limb.turns.w;
    let axis = normalize(host.along * limb.turns.x + outward * limb.turns.y);
    let across = cross(outward, host.along);
    let side = unit_or(square(cross(axis, vec3<f32>(0.0, 1.0, 0.0)) + across * 1e-3, axis), across);

    let pressure = plant.feels.xy * limb.nature.y;
    let load = vec3<f32>(pressure.x, -GRAVITY_M_PER_S2 * limb.nature.x * plant.about.w, pressure.y);
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
    let to_load = limb.table.y;
    let to_angle = list.nodes.y * to_load;
    let first = list.first_step + limb.table.x + node.x * to_angle + node.y * to_load;

    let length_m = limb.nature.z * plant.root.w;
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
        if meets_spheres && plant.feels.w > 0.0 {
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

fn first_limb(plant: Stand, list: BrushList) -> u32 {
    return list.first_limb + (u32(plant.feels.z) % (2u * VARIANTS)) * list.limbs;
}

fn limb_of(plant: Stand, row: Row, list: BrushList) -> Limb {
    return limbs[first_limb(plant, list) + (row.look.z & 0xffffu)];
}

fn row_of(plant: Stand, number: u32, list: BrushList) -> Row {
    return rows[list.first_row + u32(plant.feels.z) % VARIANTS * list.rows + number];
}

// Position of a row of a plant on ground with that normal: bends the chain of components from the root on.
fn bent_row(plant: Stand, row: Row, normal: vec3<f32>, list: BrushList) -> Bent {
    let limb_0 = first_limb(plant, list);
    let own = limb_of(plant, row, list);
    var now = ground_frame(plant);
    for (var above = own.table.w; above > 0u; above--) {
        // Host at that depth of the chain.
        var next = own;
        for (var i = 1u; i < above; i++) {
            next = limbs[limb_0 + next.table.z];
        }
        let limb = limbs[limb_0 + next.table.z];
        now = bent(now, limb, next.nature.w, min(u32(next.nature.w), limb.table.y - 1u), plant, normal, list);
    }
    let so_many = row.look.z >> 16u;
    now = bent(now, own, f32(so_many), max(so_many, 1u) - 1u, plant, normal, list);
    if row.look.x >> 16u == PETAL {
        let other = cross(now.along, now.side);
        let outward = now.side * row.petal.y + other * row.petal.z;
        let along = now.along * sqrt(1.0 - row.petal.w * row.petal.w) + outward * row.petal.w;
        now = Bent(now.at + along * (row.petal.x * plant.root.w), along, other * row.petal.y - now.side * row.petal.z);
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
fn bow(share: f32) -> f32 {
    return share * share * (1.5 - 0.5 * share);
}

@compute @workgroup_size(64)
fn ribbons(@builtin(global_invocation_id) id: vec3<u32>) {
    let owner = owners[id.x / BLOCK_ROWS];
    if owner == NOBODY {
        return;
    }
    let plant = stands[owner];
    let list = lists.list[u32(plant.tint.w)];
    let number = id.x - u32(plant.up.w) * BLOCK_ROWS;
    if number >= list.rows {
        return;
    }
    let row = row_of(plant, number, list);
    let look = row.look;
    let stuff = look.x >> 16u;
    let size = plant.root.w;
    let normal_up = plant.up.xyz;
    let bent = bent_row(plant, row, normal_up, list);
    let along = bent.along;
    var p = plant.root.xyz + bent.at;
    let own = limb_of(plant, row, list);
    if trembles && list.drops_per_m2_s * own.struck.z > 0.0 {
        let number = vec2<u32>(u32(plant.about.y * UNIT_STEPS), look.z & 0xffffu);
        // The larger the component, the less the mass of the drop counts.
        let speed = 1.0 / mix(1.0 / DROP_M_PER_S, 1.0 / own.struck.x, size * size * size);
        let dip = dip_m(speed, own.struck.y * size, own.struck.z * size * size * list.drops_per_m2_s, number, frame.time_secs);
        // The leaf does not yield along its axis.
        let down = vec3<f32>(0.0, 1.0, 0.0) - along * along.y;
        p -= down * (min(dip, FARTHEST_DIP * own.nature.z * size) * bow(f32(look.z >> 16u) / f32(own.table.y)));
    }
    let view = normalize(p - frame.eye_m);
    let toward = cross(along, view);
    let facing_side = toward / max(length(toward), 1e-3);
    var side = bent.side;
    if stuff == STALK {
        side = facing_side;
    } else if stuff != PETAL {
        // A leaf seen edge on still shows part of its width.
        side = normalize(side + facing_side * (0.35 * sign(dot(facing_side, side) + 1e-4)));
    }
    let width = look.x & 0xffffu;
    let half = max(f32(width) * WIDTH_UNIT_M * size, select(0.0, 0.45 * plant.about.z * frame.pixel_rad, width > 0u));
    let lit = Lit(p, along, side, half, view, stuff, look.y);
    borders_out[2u * id.x] = lit_border(plant, lit, -1.0);
    borders_out[2u * id.x + 1u] = lit_border(plant, lit, 1.0);
}

// A row to be lit: position on its axis (m), axis, side, half width (m), view direction, material and colour.
struct Lit {
    at: vec3<f32>,
    along: vec3<f32>,
    side: vec3<f32>,
    half: f32,
    view: vec3<f32>,
    stuff: u32,
    rgb: u32,
}

// Left (-1) or right (1) border of a row.
fn lit_border(plant: Stand, row: Lit, across: f32) -> Border {
    let normal_up = plant.up.xyz;
    var p = row.at + row.side * (across * row.half);
    p += normal_up * max(0.012 - dot(p - plant.root.xyz, normal_up), 0.0);
    var normal = normalize(cross(row.side, row.along));
    normal *= -sign(dot(normal, row.view) + 1e-5);
    let is_stalk = row.stuff == STALK;
    let rounded = normalize(normal * select(0.8, 0.55, is_stalk) + row.side * (across * select(0.25, 0.8, is_stalk)) + normal_up * 0.35);
    let root_color = unpack4x8unorm(row.rgb).rgb;
    var albedo = root_color * root_color;
    if row.stuff != PETAL {
        albedo *= plant.tint.rgb * mix(vec3<f32>(0.86, 0.98, 0.85), vec3<f32>(1.14, 1.03, 0.9), plant.about.y);
    }
    let above = dot(p - plant.root.xyz, normal_up);
    let up = clamp(above / max(plant.about.x, 0.05), 0.0, 1.0);
    let deep = smoothstep(0.0, 0.6, plant.about.x);
    let occlusion = mix(mix(0.62, 0.30, deep), 1.0, smoothstep(0.0, 0.8, up));
    let light = plant.lean.z * sun_in_grass(0.2 + up, plant.about.x);
    var color: vec3<f32>;
    if row.stuff == PETAL {
        let sun_facing = dot(normal, frame.toward_sun);
        let diffuse = clamp((abs(sun_facing) + 0.3) / 1.3, 0.0, 1.0);
        let through = 0.4 * max(dot(row.view, frame.toward_sun), 0.0) * clamp(0.6 - sun_facing, 0.0, 1.0);
        color = albedo * (frame.sun_rgb * light * (diffuse + through) * 0.8 + ambient(rounded) + lamps_on(p, rounded, 0.3));
    } else {
        color = grass_light(albedo, rounded, row.along, row.view, light, occlusion) + grass_lamps(albedo, rounded, row.along, row.view, p, up);
    }
    let grass_m = kinds.list[u32(plant.feels.z) / (2u * VARIANTS)].height_m;
    let seen = among_grass(color, plant.sward, above / grass_m) * plant.air.a + plant.air.rgb;
    let is_folded = !is_stalk & (row.stuff != PETAL);
    return Border(vec4<f32>(p, select(9.0, across, is_folded)), vec4<f32>(seen, 0.0));
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
    out.color = border.color.rgb;
    out.across = border.place.w;
    out.position = frame.projection_from_world * vec4<f32>(border.place.xyz, 1.0);
    return out;
}

@fragment
fn fs(ribbon: Ribbon) -> @location(0) vec4<f32> {
    // A leaf is folded along its middle: one half lighter than the other, the rib darker. `across` is extrapolated on ribbons that reach
    // behind the eye.
    let across = clamp(ribbon.across, -9.0, 9.0);
    let fold = 1.0 + 0.10 * across - 0.18 * (1.0 - smoothstep(0.0, 0.25, abs(across)));
    return vec4<f32>(ribbon.color * select(fold, 1.0, abs(across) > 1.5), 1.0);
}
