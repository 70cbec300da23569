// Light on grass. Twin of shared/src/light/grass.rs.

import package::constants::{LEAF_EXTINCTION, LEAST_SUN_SINE};
import package::inputs::frame::frame;
import package::inputs::grass_kinds::leafiness;
import package::inputs::lamps::{lamp_ray, lamps_about};
import package::inputs::sward_shade::{height_below, leaf_area_above, mapped_depth, sun_on_seen, SwardShade};
import package::land_and_sky::sky_light::ambient;
import package::uniforms::Kind;

// Cosine between a light (or half-way vector) and the nearest normal of a blade (Banks 1994; Kajiya & Kay 1989). Twin of `diffuse`.
fn nearest_normal(along: f32) -> f32 {
    return sqrt(max(1.0 - along * along, 0.0));
}

// Twin of `self_shadow` in shared/src/light/grass.rs.
fn self_shadow(height_fraction: f32, least: f32) -> f32 {
    return clamp(height_fraction, 0.0, 1.0) * (1.0 - least) + least;
}

// Twin of `sun_through_leaves` in shared/src/light/grass.rs.
fn sun_through_leaves(leaf_area_index: f32, depth_fraction: f32, sine_of_elevation: f32) -> f32 {
    return exp(-LEAF_EXTINCTION * leaf_area_index * max(depth_fraction, 0.0) / max(sine_of_elevation, LEAST_SUN_SINE));
}

// Leaf area index of grass 0.6 m tall and more, reduced by clumping.
const LEAF_AREA_INDEX: f32 = 1.25;
// Fraction of light that leaves transmit to those below.
const LEAF_TRANSMISSION: f32 = 0.10;

// Fraction of sunlight at a relative height in plants of a given height, after their shadow on themselves, by their height alone.
fn sun_in_plants(height_fraction: f32, plants_m: f32) -> f32 {
    let index = LEAF_AREA_INDEX * smoothstep(0.0, 0.6, plants_m);
    return mix(sun_through_leaves(index, 1.0 - height_fraction, frame.toward_sun.y), 1.0, LEAF_TRANSMISSION);
}

// Fraction of sunlight at a relative height in grass, after the shade of all grass: from the map at a height `above` relative to that of the blades as they lean; beyond the
// map from an even sward; without shadows of grass, by height alone.
fn sun_in_grass(height_fraction: f32, kind: Kind, shade: SwardShade, above: f32) -> f32 {
    let even = even_depth(kind) * leaf_area_above(height_fraction);
    let through = mix(exp(-mix(even, mapped_depth(shade, above), shade.fraction)), 1.0, LEAF_TRANSMISSION);
    return mix(sun_in_plants(height_fraction, kind.height_m), through, frame.shade_strength);
}

// Optical depth of an even sward of a kind towards the sun.
fn even_depth(kind: Kind) -> f32 {
    return frame.shade_extinction * leafiness(kind);
}

// Mean fractions of sunlight on the upper and the lower half of what an eye sees of a sward, to which it has an optical depth; without shadows of grass, at these two heights.
fn sun_on_sward(kind: Kind, shade: SwardShade, eye_depth: f32, heights: vec2<f32>) -> vec2<f32> {
    // Fractions of the leaf area above the medians of both halves.
    let above = min(vec2<f32>(log(4.0 / 3.0), log(4.0)) / eye_depth, vec2<f32>(1.0));
    let mapped = vec2<f32>(mapped_depth(shade, height_below(above.x)), mapped_depth(shade, height_below(above.y))) / above;
    let seen = sun_on_seen(eye_depth, mix(vec2<f32>(even_depth(kind)), mapped, shade.fraction));
    let by_height = vec2<f32>(sun_in_plants(heights.x, kind.height_m), sun_in_plants(heights.y, kind.height_m));
    return mix(by_height, mix(seen, vec2<f32>(1.0), LEAF_TRANSMISSION), frame.shade_strength);
}

// Reflectance of a blade: diffuse reflection from a partly rounded strip (its own normal, and Kajiya & Kay), transmission mostly straight
// on, and a highlight along it. `view` runs from the eye to the point. Averaged over all directions, the total is at most 1.1 times the
// albedo.
fn leaf_light(albedo: vec3<f32>, normal: vec3<f32>, tangent: vec3<f32>, view: vec3<f32>, toward: vec3<f32>) -> vec3<f32> {
    let facing = dot(normal, toward);
    let strip = clamp((facing + 0.35) / 1.35, 0.0, 1.0);
    let diffuse = mix(strip, strip * nearest_normal(dot(tangent, toward)), 0.4);
    let against = max(dot(view, toward), 0.0);
    let through = (0.18 + 1.0 * against * against * against) * clamp(0.55 - 0.45 * facing, 0.0, 1.0);
    let half_way = normalize(toward - view);
    let grazing = 1.0 - max(dot(half_way, toward), 0.0);
    let grazing2 = grazing * grazing;
    let mirrored = 0.05 + 0.6 * grazing2 * grazing2 * grazing;
    let sheen = pow(nearest_normal(dot(tangent, half_way)), 36.0) * mirrored;
    return albedo * diffuse + albedo * vec3<f32>(1.12, 1.06, 0.60) * through + vec3<f32>(sheen) * strip;
}

// Light of sun and sky on thin leaves. `sun_light` is the fraction of unshadowed sunlight; `occlusion` 0..1 darkens points deep in the
// grass.
fn grass_light(
    albedo: vec3<f32>, normal: vec3<f32>, tangent: vec3<f32>, view: vec3<f32>, sun_light: f32, occlusion: f32,
) -> vec3<f32> {
    let direct = frame.sun_rgb * sun_light * leaf_light(albedo, normal, tangent, view, frame.toward_sun);
    let around = ambient(normal);
    // The waxy skin reflects a little of the sky.
    return direct * mix(0.25, 1.0, occlusion) + (albedo + 0.04 + 0.03 * sun_light) * around * occlusion;
}

// Light of all lamps on thin leaves, at a relative height in the grass.
fn grass_lamps(albedo: vec3<f32>, normal: vec3<f32>, tangent: vec3<f32>, view: vec3<f32>, p: vec3<f32>, height_fraction: f32) -> vec3<f32> {
    var light = vec3<f32>(0.0);
    for (var i = 0u; i < lamps_about(p); i++) {
        if distance(p, frame.lights.lamps[i].position_m) < frame.lights.lamps[i].reach_m {
            let ray = lamp_ray(frame.lights.lamps[i], p);
            light += ray.rgb * leaf_light(albedo, normal, tangent, view, ray.toward);
        }
    }
    return light * self_shadow(height_fraction, 0.3);
}
