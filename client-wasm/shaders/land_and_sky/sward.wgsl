// Colour of grass: of a point of a blade, and of a whole sward seen from afar.

import package::constants::{LEAF_CLUMPING, LEAF_EXTINCTION, LEAST_DENSITY_DISTANCE_M, TAU};
import package::inputs::frame::frame;
import package::inputs::grass_kinds::leafiness;
import package::inputs::sward_shade::SwardShade;
import package::land_and_sky::grass_color::{plant_color, trodden};
import package::land_and_sky::grass_light::{grass_lamps, grass_light, sun_on_sward};
import package::uniforms::Kind;

// Fraction of straw in the colour of a blade of a hue.
fn straw_of(hue: f32) -> f32 {
    return smoothstep(0.86, 0.99, hue) * 0.75;
}

// Its mean over all hues.
const MEAN_STRAW: f32 = 0.05625;

// Light from a blade to the eye, at fraction `t` of its length and at `height` relative to the mean height of its kind. `view` runs from the
// eye to `p`, `lit` is the fraction of unshadowed sunlight that reaches the blade, `hue` runs from fresh to dry.
fn blade_color(
    kind: Kind, tint: vec3<f32>, t: f32, height: f32, hue: f32, straw: f32, tilt: f32, normal: vec3<f32>, tangent: vec3<f32>, view: vec3<f32>, p: vec3<f32>,
    lit: f32,
) -> vec3<f32> {
    var albedo = tint * plant_color(kind.root_rgb, kind.tip_rgb, t, hue);
    albedo = mix(albedo, vec3<f32>(0.38, 0.30, 0.13) * (0.35 + 0.65 * t), straw);
    // Pale ends, as in flowering grass.
    albedo = mix(albedo, albedo * vec3<f32>(1.35, 1.12, 0.95), smoothstep(0.72, 1.0, t) * smoothstep(0.3, 0.9, hue));
    albedo *= (0.90 + 0.42 * smoothstep(0.15, 0.6, sin(tilt)) * t) * trodden(tilt);
    // Short grass loses little light on the way down.
    let deep = smoothstep(0.0, 0.60, kind.height_m);
    let occlusion = mix(mix(0.60, 0.16, deep), 1.0, smoothstep(0.0, 0.85, max(height, t * 0.75)));
    return grass_light(albedo, normal, tangent, view, lit, occlusion) + grass_lamps(albedo, normal, tangent, view, p, height);
}

// Extinction coefficient of visible leaves: less than `LEAF_EXTINCTION`, since blades in tufts hide each other.
const VISIBLE_LEAF_EXTINCTION: f32 = 0.3;
// Depth below the tallest blades at which a level view ray ends on blades, relative to their height.
const CANOPY_TOP_DEPTH: f32 = 0.1;

// Density of plants at a distance, relative to the full density up to `full_m`; the number per pixel is constant beyond.
fn density(distance_m: f32, full_m: f32) -> f32 {
    let near = full_m / max(distance_m, LEAST_DENSITY_DISTANCE_M);
    return min(near * near, 1.0);
}

// Leaf area index of blades drawn at a distance, which are fewer there, and wider.
fn drawn_leaf_area(distance_m: f32, kind: Kind) -> f32 {
    let shown = 1.0 - smoothstep(frame.blades_fade_from_m, frame.blades_end_m, distance_m);
    return frame.leaf_area * sqrt(density(distance_m, frame.full_density_m)) * shown * leafiness(kind);
}

// Distance beyond which the grass around a plant has its far look (m).
const AFAR_FROM_M: f32 = 2.0;

// Visibility of the sward's far look between the drawn blades: gaps are dark where blades hide the ground, and the darker the larger the
// fraction of all blades that is drawn.
fn bare_between(distance_m: f32, kind: Kind, view: vec3<f32>, up: vec3<f32>) -> f32 {
    let drawn = drawn_leaf_area(distance_m, kind);
    let hidden = 1.0 - exp(-LEAF_EXTINCTION * drawn / clamp(-dot(view, up), 0.3, 1.0));
    let bare = 1.0 - hidden * hidden * min(drawn / (frame.leaf_area * leafiness(kind)), 1.0);
    // An eye in the grass looks between the blades.
    return bare * smoothstep(0.1, AFAR_FROM_M, distance_m);
}

// Contrast of a single blade: of several per pixel only the mean is visible, which varies as the square root of their number.
fn contrast(distance_m: f32) -> f32 {
    return clamp(sqrt(1.5 * frame.blade_width_m / (distance_m * frame.pixel_rad)), 0.0, 1.0);
}

// Colour of a part of a plant at height `up` in the grass (0 at the ground, 1 at its top), mixed with the far look of the grass around it
// (`about`): near the ground it merges with blades that are not drawn. Where it stands alone its whole area, not only a pixel, shows the mean of the several
// blades that it stands for.
fn among(color: vec3<f32>, about: vec4<f32>, up: f32, distance_m: f32) -> vec3<f32> {
    let single = contrast(distance_m);
    let own = single * (1.0 - about.w * (1.0 - single * smoothstep(0.0, 0.8, up)));
    return mix(about.rgb, color, own);
}

// Leaf area index of a kind of grass.
fn leaf_area_of(kind: Kind) -> f32 {
    return frame.leaf_area * leafiness(kind);
}

// Mean of the highlights along blades that lean in all directions, relative to sunlight: fitted to pictures of every blade without a far look, of meadow and
// continuum with the sun behind and before the eye.
const SWARD_SHEEN: f32 = 0.008;

// Colour of a sward seen from afar: two layers of leaves, each with half of the visible leaf area; deeper leaves show less.
fn sward_color(
    p: vec3<f32>, up: vec3<f32>, kind: Kind, tint: vec3<f32>, lean: vec2<f32>, view: vec3<f32>, light: f32, shade: SwardShade,
) -> vec3<f32> {
    let leaf_area = leaf_area_of(kind);
    let free = clamp(-dot(view, up), 0.05, 1.0) / (VISIBLE_LEAF_EXTINCTION * max(leaf_area, 0.05));
    let heights = max(1.0 - CANOPY_TOP_DEPTH - free * vec2<f32>(0.29, 1.39), vec2<f32>(0.0));
    let along = mix(heights, vec2<f32>(1.0), 0.35);
    // Optical depth towards the eye by the model of the shade, of upright blades that face all directions.
    let eye_depth = LEAF_CLUMPING * 4.0 / TAU * max(leaf_area, 0.05) / clamp(-dot(view, up), 0.05, 1.0);
    let lit = light * sun_on_sward(kind, shade, eye_depth, max(heights, along * 0.7));
    let tilt = length(lean);
    let tangent = normalize(up + vec3<f32>(lean.x, 0.0, lean.y) * 1.4);
    // Blades point in all directions, and those that face the eye are seen.
    let facing = normalize(up * 0.75 - (view - up * dot(view, up)) * 0.45 + vec3<f32>(lean.x, 0.0, lean.y) * 0.3);
    var color = vec3<f32>(0.0);
    for (var i = 0; i < 2; i++) {
        let hue = select(0.65, 0.35, i == 0);
        color += blade_color(kind, tint, along[i], heights[i], hue, MEAN_STRAW, tilt, facing, tangent, view, p, lit[i]);
    }
    return 0.5 * color + frame.sun_rgb * (light * SWARD_SHEEN);
}
