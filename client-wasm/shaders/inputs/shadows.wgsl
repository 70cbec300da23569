// Shadows of objects and trees.

import package::constants::TAU;
import package::inputs::frame::frame;
import package::inputs::random::random3;

@group(0) @binding(9) var shadows: texture_depth_2d_array;
@group(0) @binding(10) var shadow_sampler: sampler_comparison;

// Angle of the disc of the sun (rad), with the bright haze around it.
const SUN_RAD: f32 = 0.014;

// Greatest half-width of a penumbra (texels of the map).
const SOFTEST_PX: f32 = 4.0;

// Whether shadows have penumbras. They are most of the price of a shadow in software.
override soft_shadows: bool = true;

// Depth at which a position is compared with the map: a little nearer to the sun than its own.
fn compared_depth(place: vec3<f32>, depth_m: f32, texel_m: f32) -> f32 {
    return place.z - 0.6 * (0.2 + texel_m) / depth_m;
}

// Fraction of sunlight at a position in a layer of the shadow map, between four texels.
fn hard_shadow(place: vec3<f32>, layer: i32, depth_m: f32, texel_m: f32) -> f32 {
    return textureSampleCompareLevel(shadows, shadow_sampler, place.xy, layer, compared_depth(place, depth_m, texel_m));
}

// Fraction of sunlight at a position in a layer of the shadow map, by percentage-closer soft shadows (Fernando 2005): four texels around
// the position estimate the distance of the occluder and so the width of the penumbra, four comparisons the fraction of the sun that it
// hides. Fully lit where none of the texels is occluded.
fn soft_shadow(place: vec3<f32>, layer: i32, depth_m: f32, texel_m: f32, turn: vec2<f32>) -> f32 {
    let size = vec2<f32>(textureDimensions(shadows));
    let depth = compared_depth(place, depth_m, texel_m);
    var nearest_m = 0.0;
    var found = 0.0;
    for (var i = 0; i < 4; i++) {
        let offset = spread(i, turn) * SOFTEST_PX * 0.75;
        let at = vec2<i32>(clamp(place.xy * size + offset, vec2<f32>(0.0), size - 1.0));
        let away_m = (depth - textureLoad(shadows, at, layer, 0)) * depth_m;
        if away_m > 0.0 {
            nearest_m += away_m;
            found += 1.0;
        }
    }
    if found == 0.0 {
        return 1.0;
    }
    let half_px = clamp(nearest_m / found * SUN_RAD * 0.5 / texel_m, 0.8, SOFTEST_PX);
    var light = 0.0;
    for (var i = 0; i < 4; i++) {
        light += textureSampleCompareLevel(shadows, shadow_sampler, place.xy + spread(i, turn) * half_px / size, layer, depth);
    }
    return light * 0.25;
}

// Four points of a rotated disc.
fn spread(i: i32, turn: vec2<f32>) -> vec2<f32> {
    let at = array<vec2<f32>, 4>(vec2<f32>(0.35, 0.1), vec2<f32>(-0.15, 0.65), vec2<f32>(-0.8, -0.25), vec2<f32>(0.3, -0.85))[i];
    return vec2<f32>(at.x * turn.x - at.y * turn.y, at.x * turn.y + at.y * turn.x);
}

// Random unit vector that turns the samples; not used by hard shadows.
fn turn_at(p: vec3<f32>) -> vec2<f32> {
    if !soft_shadows {
        return vec2<f32>(0.0);
    }
    let angle = random3(vec2<i32>(floor(p.xz * 97.0)), bitcast<u32>(i32(floor(p.y * 97.0)))).x * TAU;
    return vec2<f32>(cos(angle), sin(angle));
}

// Fraction of sunlight at a position in a layer of the shadow map.
fn shadow(place: vec3<f32>, layer: i32, depth_m: f32, texel_m: f32, turn: vec2<f32>) -> f32 {
    if !soft_shadows {
        return hard_shadow(place, layer, depth_m, texel_m);
    }
    return soft_shadow(place, layer, depth_m, texel_m, turn);
}

// Fraction of the sun that objects and trees leave at a position: from the sharp cascade nearby, from the coarse one farther away.
fn sun_visible(p: vec3<f32>) -> f32 {
    let turn = turn_at(p);
    let near = (frame.shadow_from_world * vec4<f32>(p, 1.0)).xyz;
    let far = (frame.lights.far_shadow_from_world * vec4<f32>(p, 1.0)).xyz;
    let off = border_of(near);
    let far_off = border_of(far);
    // Most positions are in one cascade alone.
    let first = select(0, 1, off >= 0.98);
    let last = select(1, 2, off >= 0.88 && far_off < 0.98);
    var light = 1.0;
    for (var layer = first; layer < last; layer++) {
        let is_far = layer == 1;
        let place = select(near, far, is_far);
        let texel_m = select(frame.lights.near_texel_m, frame.lights.far_texel_m, is_far);
        let depth_m = select(frame.lights.near_depth_m, frame.lights.far_depth_m, is_far);
        let seen = shadow(vec3<f32>(place.xy * vec2<f32>(0.5, -0.5) + 0.5, place.z), layer, depth_m, texel_m, turn);
        let fraction = select(1.0, smoothstep(0.88, 0.98, off) * (1.0 - smoothstep(0.85, 0.98, far_off)), is_far);
        light = mix(light, seen, fraction);
    }
    return light;
}

// Distance from the middle of the shadow map, 1 at its border.
fn border_of(place: vec3<f32>) -> f32 {
    return max(max(abs(place.x), abs(place.y)), abs(place.z * 2.0 - 1.0));
}
