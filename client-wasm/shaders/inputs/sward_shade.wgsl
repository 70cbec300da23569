// Shade that the sward casts, from a map around the camera. Twin of shared/src/light/shade.rs.

import package::constants::{FLAT_RAD, LEAF_CLUMPING, LEAF_TOP, LEAST_SUN_SINE, RESTING_RAD, TAU, THIRD_AREAS, WIND_SHAPE};
import package::inputs::frame::{clamped, frame};

// Mean height of the blades (m), and square roots of the optical depth towards the sun at the ground, half way to the highest leaves, and there.
@group(0) @binding(16) var shade_map: texture_2d<f32>;

// Shade at a position of the land.
struct SwardShade {
    // As in the map.
    height_m: f32,
    root_depths: vec3<f32>,
    // Weight of the map: it fades to 0 at its border.
    fraction: f32,
}

fn shade_at(p: vec2<f32>) -> SwardShade {
    let place = (p - frame.shade_corner_m) / frame.shade_extent_m;
    let found = textureSampleLevel(shade_map, clamped, place, 0.0);
    let off = abs(2.0 * place - 1.0);
    return SwardShade(max(found.x, 0.01), found.yzw, 1.0 - smoothstep(0.84, 0.97, max(off.x, off.y)));
}

// Optical depth between the sun and a height relative to the mean height of the blades. Its root falls evenly in an even sward.
fn mapped_depth(shade: SwardShade, height: f32) -> f32 {
    let at = clamp(height, 0.0, LEAF_TOP) * (2.0 / LEAF_TOP);
    let roots = shade.root_depths;
    let root = select(mix(roots.x, roots.y, at), mix(roots.y, roots.z, at - 1.0), at > 1.0);
    return root * root;
}

// Fraction of sunlight that the sward leaves at a height above the ground (m), for anything but its own blades.
fn sun_over_grass(shade: SwardShade, above_m: f32) -> f32 {
    return exp(-mapped_depth(shade, above_m / shade.height_m) * shade.fraction * frame.shade_strength);
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
