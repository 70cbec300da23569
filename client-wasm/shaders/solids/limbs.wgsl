// Trees of components: trunk, limbs and twigs, each bent by the table of postures that they share (Endo et al. 2003, section 4.2), and the vertices
// that follow them. Twin of `posed` in shared/src/plant/underbrush/plant.rs and of `followed_m` in shared/src/plant/tree/statics.rs.

import package::constants::{GRAVITY_M_PER_S2, LEAF_STIFFNESS_PA, MIDDLE_LOAD, TAU, TREE_ANGLES, TREE_LOADS, TREE_SECTIONS};
import package::gpu::vectors::{arc_cosine, square, unit_or};
import package::inputs::frame::frame;

// A component of a tree one metre tall. Its host is the component that carries it.
struct TreeLimb {
    // Cosine and sine of its angle from its host.
    angle: vec2<f32>,
    // Cosine and sine of its rotation around the host.
    turn: vec2<f32>,
    // Load per force per mass and height of the tree (s²/m²).
    load_s2_per_m2: f32,
    // Load per pressure (1/Pa).
    load_per_pa: f32,
    length: f32,
    // Position on its host, as a fraction of the length of that.
    host_fraction: f32,
    // Number of its host.
    host: u32,
    // Number of its hosts, down to the trunk.
    depth: u32,
    // Natural frequency times the height of the tree (rad·m/s).
    swing_rad_m_per_s: f32,
    unused: f32,
}

// A bent component in the frame of its tree.
struct BentLimb {
    foot: vec3<f32>,
    length: f32,
    axis: vec3<f32>,
    // Across the axis, towards the load: it bends in the plane of both.
    towards: vec3<f32>,
    // To its right, before it bends.
    side: vec3<f32>,
    // End of each section along `axis` and `towards` (lengths), and cosine and sine of its angle from the axis.
    sections: array<vec4<f32>, TREE_SECTIONS>,
}

// Position on a component, and its axes there.
struct OnLimb {
    at: vec3<f32>,
    along: vec3<f32>,
    side: vec3<f32>,
}

@group(1) @binding(4) var<storage, read> bent_limbs: array<BentLimb>;
@group(1) @binding(6) var<storage, read> tree_limbs: array<TreeLimb>;
// Angle of each section from the unbent axis (rad), by the angle of that axis and by the load.
@group(1) @binding(7) var<storage, read> postures: array<f32>;

// A vector of the unbent component, turned with a section of that cosine and sine.
fn turned(limb: BentLimb, v: vec3<f32>, cosine: f32, sine: f32) -> vec3<f32> {
    let around = cross(limb.axis, limb.towards);
    let onward = (limb.axis * cosine + limb.towards * sine) * dot(v, limb.axis);
    return onward + around * dot(v, around) + (limb.towards * cosine - limb.axis * sine) * dot(v, limb.towards);
}

// A component on its host, under the pressure of the air (Pa, in the frame of the tree).
fn bent_limb(limb: TreeLimb, host: OnLimb, pressure_pa: vec3<f32>, tall_m: f32) -> BentLimb {
    let outward = host.side * limb.turn.x - cross(host.along, host.side) * limb.turn.y;
    var out: BentLimb;
    out.foot = host.at;
    out.length = limb.length;
    out.axis = normalize(host.along * limb.angle.x + outward * limb.angle.y);
    let across = cross(outward, host.along);
    out.side = unit_or(square(cross(out.axis, vec3<f32>(0.0, 1.0, 0.0)) + across * 1e-3, out.axis), across);

    let load = pressure_pa * limb.load_per_pa - vec3<f32>(0.0, GRAVITY_M_PER_S2 * limb.load_s2_per_m2 * tall_m, 0.0);
    let size = length(load);
    let down = load / max(size, 1e-30);
    let away = cross(out.axis, out.side);
    out.towards = unit_or(square(square(down, out.axis) + away * 1e-6, out.axis), away);

    let nodes = vec2<f32>(f32(TREE_ANGLES - 1u), f32(TREE_LOADS - 1u));
    let angle = arc_cosine(clamp(-dot(down, out.axis), -1.0, 1.0));
    let place = vec2<f32>(sqrt(angle * 2.0 / TAU), 1.0 - MIDDLE_LOAD / (size + MIDDLE_LOAD)) * nodes;
    let node = min(vec2<u32>(place), vec2<u32>(TREE_ANGLES - 2u, TREE_LOADS - 2u));
    let by = place - vec2<f32>(node);
    let first = (node.x * TREE_LOADS + node.y) * TREE_SECTIONS;
    var end = vec2<f32>(0.0);
    for (var i = 0u; i < TREE_SECTIONS; i++) {
        let at = first + i;
        let lighter = mix(postures[at], postures[at + TREE_SECTIONS], by.y);
        let heavier = mix(postures[at + TREE_LOADS * TREE_SECTIONS], postures[at + (TREE_LOADS + 1u) * TREE_SECTIONS], by.y);
        let bend = mix(lighter, heavier, by.x);
        let way = vec2<f32>(cos(bend), sin(bend));
        end += way / f32(TREE_SECTIONS);
        out.sections[i] = vec4<f32>(end, way);
    }
    return out;
}

// Number of the section at a fraction of the length.
fn section_at(fraction: f32) -> u32 {
    return min(u32(clamp(fraction, 0.0, 1.0) * f32(TREE_SECTIONS)), TREE_SECTIONS - 1u);
}

// A place at a fraction of the length, which may lie beyond the ends, in the section of that number.
fn place_on(limb: BentLimb, section: vec4<f32>, fraction: f32, number: u32) -> vec3<f32> {
    let at = section.xy + section.zw * (fraction - f32(number + 1u) / f32(TREE_SECTIONS));
    return limb.foot + (limb.axis * at.x + limb.towards * at.y) * limb.length;
}

fn on_limb(limb: BentLimb, fraction: f32) -> OnLimb {
    var sections = limb.sections;
    let number = section_at(fraction);
    let section = sections[number];
    let along = limb.axis * section.z + limb.towards * section.w;
    let side = turned(limb, limb.side, section.z, section.w);
    return OnLimb(place_on(limb, section, fraction, number), along, side);
}

// Pressure on a component (Pa, in the frame of its tree): that of the wind, about which it swings at its natural frequency. `number` is that of the
// component in its tree, `turn` the axes X and Z of the tree, `phase` that of the tree (rad).
fn swinging(limb: TreeLimb, number: u32, pressure_pa: vec2<f32>, turn: mat2x2<f32>, tall_m: f32, phase: f32) -> vec3<f32> {
    let swing = frame.time_secs * limb.swing_rad_m_per_s / tall_m + phase + 2.4 * f32(number);
    let pressure = pressure_pa * turn * (0.75 + 0.25 * sin(swing));
    return vec3<f32>(pressure.x, 0.0, pressure.y);
}

// Component `number` of the tree whose components begin at `first`, bent with all that carry it.
fn bent_in_tree(first: u32, number: u32, pressure_pa: vec2<f32>, turn: mat2x2<f32>, tall_m: f32, phase: f32) -> BentLimb {
    let own = tree_limbs[first + number];
    var host = OnLimb(vec3<f32>(0.0), vec3<f32>(0.0, 1.0, 0.0), vec3<f32>(0.0, 0.0, -1.0));
    for (var above = own.depth; above > 0u; above--) {
        // Host at that depth of the chain, and the next one, which it carries.
        var carried = own;
        for (var i = 1u; i < above; i++) {
            carried = tree_limbs[first + carried.host];
        }
        let limb = tree_limbs[first + carried.host];
        let bent = bent_limb(limb, host, swinging(limb, carried.host, pressure_pa, turn, tall_m, phase), tall_m);
        host = on_limb(bent, carried.host_fraction);
    }
    return bent_limb(own, host, swinging(own, number, pressure_pa, turn, tall_m, phase), tall_m);
}

// A vertex that follows a component: position and normal in the frame of the tree.
struct Followed {
    position: vec3<f32>,
    normal: vec3<f32>,
}

// The place of a vertex that is `local` to the unbent component: to its right, along its axis, and across both. Leaves are components of one section
// that stand on it; under the pressure of the air they point along the sum of their stiffness and the load, as in shared/src/plant/underbrush/section.rs.
fn of_limb(row: u32, local: vec3<f32>, normal: vec3<f32>, is_leaf: bool, pressure_pa: vec3<f32>) -> Followed {
    let fraction = local.y / bent_limbs[row].length;
    let number = section_at(fraction);
    let section = bent_limbs[row].sections[number];
    let limb = bent_limbs[row];
    let other = cross(limb.axis, limb.side);
    let aside = turned(limb, limb.side * local.x + other * local.z, section.z, section.w);
    let blown = unit_or(unit_or(aside, limb.axis) * LEAF_STIFFNESS_PA + pressure_pa, aside) * length(aside);
    let facing = limb.side * normal.x + limb.axis * normal.y + other * normal.z;
    let position = place_on(limb, section, fraction, number) + select(aside, blown, is_leaf);
    return Followed(position, turned(limb, facing, section.z, section.w));
}
