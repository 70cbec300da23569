// Shade that the sward casts, from two maps around the camera. Twin of shared/src/light/shade.rs.

import package::constants::{
    FLAT_RAD, LEAF_CLUMPING, LEAF_TOP, LEAST_SUN_SINE, RESTING_RAD, SHADE_CELL_M, SHADE_PX, TAU, THIRD_AREAS, WIND_SHAPE,
};
import package::inputs::frame::{clamped, frame};

// Mean height of the blades (m), and square roots of the optical depth towards the sun at the ground, half way to the highest leaves, and there.
// The first layer is the map near the camera, the second the coarser one.
@group(0) @binding(16) var shade_maps: texture_2d_array<f32>;

// Shade at a position of the land.
struct SwardShade {
    // As in the maps.
    height_m: f32,
    root_depths: vec3<f32>,
    // Weight of the maps: it fades to 0 at the border of the coarser one.
    fraction: f32,
}

fn shade_corner_m(map: u32) -> vec2<f32> {
    return select(frame.shade_corner_m, frame.shade_far_corner_m, map > 0u);
}

// Side of the cells of a map (m).
fn shade_cell_m(map: u32) -> f32 {
    return select(SHADE_CELL_M[0], SHADE_CELL_M[1], map > 0u);
}

// Weight of a map at a place in it (0 to 1 along each side): it fades to 0 at the border.
fn weight_in_map(place: vec2<f32>) -> f32 {
    let off = abs(2.0 * place - 1.0);
    return 1.0 - smoothstep(0.84, 0.97, max(off.x, off.y));
}

// One sample of the finer map that covers the position, and of both where it fades.
fn shade_at(p: vec2<f32>) -> SwardShade {
    let near = (p - shade_corner_m(0u)) / (f32(SHADE_PX) * shade_cell_m(0u));
    let far = (p - shade_corner_m(1u)) / (f32(SHADE_PX) * shade_cell_m(1u));
    let is_near = weight_in_map(near);
    var found = vec4<f32>(0.0);
    for (var map = select(0, 1, is_near <= 0.0); map < select(2, 1, is_near >= 1.0); map++) {
        let place = select(near, far, map == 1);
        found += textureSampleLevel(shade_maps, clamped, place, map, 0.0) * select(is_near, 1.0 - is_near, map == 1);
    }
    return SwardShade(max(found.x, 0.01), found.yzw, weight_in_map(far));
}

// Optical depth between the sun and a height relative to the mean height of the blades. Its root falls evenly in an even sward.
fn mapped_depth(shade: SwardShade, height: f32) -> f32 {
    let at = clamp(height, 0.0, LEAF_TOP) * (2.0 / LEAF_TOP);
    let roots = shade.root_depths;
    let root = select(mix(roots.x, roots.y, at), mix(roots.y, roots.z, at - 1.0), at > 1.0);
    return root * root;
}

// Fraction of sunlight that the sward leaves at a height above the ground (m), for anything but its own blades. Beyond the maps it is that of an even sward with
// an optical depth and a height (m).
fn sun_over_grass(shade: SwardShade, above_m: f32, even_depth: f32, even_m: f32) -> f32 {
    let even = even_depth * leaf_area_above(above_m / even_m);
    return exp(-mix(even, mapped_depth(shade, above_m / shade.height_m), shade.fraction) * frame.shade_strength);
}

// Mean fractions of sunlight on the upper and the lower half of the leaves, or of the ground below them, at which rays of the eye end in an even sward of these optical
// depths towards the eye and, for each half, towards the sun. Twin of `sun_on_seen`.
fn sun_on_seen(eye_depth: f32, sun_depths: vec2<f32>) -> vec2<f32> {
    let both = eye_depth + sun_depths;
    let parted = exp(-both * min(log(2.0) / eye_depth, 1.0));
    let ends = exp(-both);
    let ground = exp(-eye_depth);
    let leaves = vec2<f32>(1.0 - parted.x, parted.y - ends.y) * eye_depth / both;
    return 2.0 * (leaves + vec2<f32>(max(ground - 0.5, 0.0), min(ground, 0.5)) * exp(-sun_depths));
}

// Relative height above which a fraction of the leaf area is. Inverse of `leaf_area_above`.
fn height_below(leaf_area: f32) -> f32 {
    return LEAF_TOP * (1.0 - sqrt(clamp(leaf_area, 0.0, 1.0)));
}

// Twin of `leaf_area_above`.
fn leaf_area_above(height: f32) -> f32 {
    let below_top = 1.0 - clamp(height, 0.0, LEAF_TOP) / LEAF_TOP;
    return below_top * below_top;
}

// Twin of `stance`.
fn stance(lean_rad: vec2<f32>, droop: f32) -> vec2<f32> {
    let toward = above_horizon();
    let flat_fraction = smoothstep(0.5, 1.3, length(lean_rad));
    var shapes = WIND_SHAPE;
    var areas = THIRD_AREAS;
    var found = vec2<f32>(0.0);
    for (var part = 0; part < 12; part++) {
        let third = part >> 2u;
        let fraction = (f32(third) + 1.0) / 3.0;
        let rests = RESTING_RAD * droop * fraction * (1.6 - 1.1 * flat_fraction) * select(-1.0, 1.0, (part & 1) == 0);
        let way = select(vec2<f32>(0.0, rests), vec2<f32>(rests, 0.0), (part & 2) == 0);
        let lean = lean_rad * mix(shapes[third], 1.0 + 0.06 * fraction, flat_fraction) + way;
        let angle = max(length(lean), 1e-6);
        let level = dot(lean, toward.xz) / angle;
        let sine = sin(min(angle, FLAT_RAD));
        let cosine = cos(min(angle, FLAT_RAD));
        let along = sine * level + cosine * toward.y;
        let across = cosine * level - sine * toward.y;
        found += vec2<f32>(cosine / 12.0, 0.125 * areas[third] * (4.0 / TAU * sqrt(max(1.0 - along * along, 0.0)) + abs(across)));
    }
    return vec2<f32>(found.x, LEAF_CLUMPING * found.y / toward.y);
}

// Direction to the sun, raised to the least elevation at which it lights grass.
fn above_horizon() -> vec3<f32> {
    let sun = frame.toward_sun;
    let sine = max(sun.y, LEAST_SUN_SINE);
    let level = sqrt(max(1.0 - sine * sine, 0.0) / max(dot(sun.xz, sun.xz), 1e-8));
    return vec3<f32>(sun.x * level, sine, sun.z * level);
}
