// Shells (Bakay): layers of one texture of cross-sections that lean without changing the length of a blade. Between two layers the view ray
// is sampled in slices, so that it meets blades there at grazing angles.

import package::constants::{RIGHT_ANGLE, SHELL_BLADE_PX, TILE_VERTICES, WORKGROUP_SIZE};
import package::inputs::bend_atlas::{field_level, lean_in};
import package::inputs::frame::{frame, runtime_zero, repeated};
import package::inputs::grass_kinds::kinds_blended;
import package::inputs::noise::noise;
import package::inputs::random::gradient_noise;
import package::inputs::shadows::sun_visible;
import package::inputs::wind::gust_at;
import package::land_and_sky::clouds::cloud_light;
import package::land_and_sky::grass_color::{grass_tint, plant_color, trodden};
import package::land_and_sky::grass_light::{grass_lamps, grass_light};
import package::land_and_sky::ground::{fed, grass_fraction, ground_height, ground_normal};
import package::land_and_sky::ground_tile::{GroundTile, tile_vertex};
import package::land_and_sky::haze::hazed;
import package::plants::force_field::sheltered_at;
import package::uniforms::ShellFrame;

// Size of the pattern of clumps (m).
const CLUMP_M: f32 = 1.3;
// Maximum deflection of blades without wind, relative to the height of the tallest.
const REST_DEFLECTION: f32 = 0.9;
// Relative height whose light represents all heights within a far pixel.
const MEAN_HEIGHT: f32 = 0.66;
// Decay time of the effect of a gust on grass (s): it sets in at once and fades slowly (Bakay, section 3.2).
const RELEASE_SECS: f32 = 0.9;

// State of a vertex of the mesh, shared by all layers.
struct Turf {
    // Position on the ground (m).
    root_m: vec3<f32>,
    // Height of the tallest blade (m).
    height_m: f32,
    // Unit normal of the ground.
    normal: vec3<f32>,
    // Tilt of the root (rad).
    tilt_rad: f32,
    // Unit vector of the wind, perpendicular to `axis`.
    wind_direction: vec3<f32>,
    // Wind intensity of `tilt_of`.
    wind_intensity: f32,
    // Colour at the root.
    root_rgb: vec3<f32>,
    // Fraction of unshadowed sunlight.
    sunlight: f32,
    // Colour at the tip.
    tip_rgb: vec3<f32>,
    // Fraction of its full height that grass has there.
    growth: f32,
    // Unit vector along upright blades.
    axis: vec3<f32>,
    // Progress of the morph to the next coarser tile, 0..1.
    morph: f32,
}

// A layer of a tile to be drawn.
struct TileLayer {
    // Number of the layer in the low byte, number of the tile above it.
    tile_and_layer: u32,
    // Segments down to the next layer.
    to_next: u32,
    // Segments down to the layer after that one.
    to_second: u32,
    // 1 if the layer ends where the next coarser tiles begin.
    ends: u32,
}

@group(1) @binding(0) var<storage, read> tiles: array<GroundTile>;
@group(1) @binding(1) var<uniform> shells: ShellFrame;
@group(1) @binding(2) var<storage, read> turfs: array<Turf>;
@group(1) @binding(3) var dots: texture_2d<f32>;
@group(1) @binding(4) var<storage, read> tile_layers: array<TileLayer>;
@group(1) @binding(5) var<storage, read_write> settled: array<Turf>;

// Whether the scene has another stiffness profile than a constant increment of the tilt. Fixed when a pipeline is made.
override has_profile: bool = true;

// Sum of the segments above layer `low` up to layer `high` of a blade with a tilted root in the wind, along its axis and along the wind, in
// blade heights. Twin of `Tilt::of_segment_rad` in shared/src/lod/shells.rs, summed.
fn segments_between(root_rad: f32, intensity: f32, profile: f32, low: f32, high: f32, segments: f32) -> vec2<f32> {
    var sum = vec2<f32>(0.0);
    for (var j = low + 1.0; j <= high; j += 1.0) {
        let tilt_rad = root_rad + pow(j / segments, 1.0 + profile) * RIGHT_ANGLE * intensity;
        sum += vec2<f32>(cos(tilt_rad), sin(tilt_rad));
    }
    return sum / segments;
}

// Position of layer `i` of a blade with a tilted root in the wind, along its axis and along the wind, in blade heights. Twin of
// `Tilt::layer` in shared/src/lod/shells.rs.
fn layer_place(root_rad: f32, intensity: f32, profile: f32, i: f32, segments: f32) -> vec2<f32> {
    if has_profile {
        return segments_between(root_rad, intensity, profile, 0.0, i, segments);
    }
    let half = 0.5 * RIGHT_ANGLE * intensity / segments;
    let sum = select(i, sin(i * half) / sin(max(half, 1e-4)), half > 1e-4);
    let middle = root_rad + (i + 1.0) * half;
    return vec2<f32>(cos(middle), sin(middle)) * (sum / segments);
}

// Tilt of the root (rad) and wind intensity of a blade with a mean lean (rad). Twin of `Tilt::of_lean`.
fn tilt_of(lean_rad: f32) -> vec2<f32> {
    let twice = 2.0 * clamp(lean_rad, 0.0, 1.5);
    let root_rad = max(twice - RIGHT_ANGLE, 0.0);
    return vec2<f32>(root_rad, (min(twice, RIGHT_ANGLE) - root_rad) / RIGHT_ANGLE);
}

// Unit vector along blades without wind: the normal of the ground, or straight up (Bakay, section 3.1).
fn upright_axis(normal: vec3<f32>, is_upright: u32) -> vec3<f32> {
    return select(normal, vec3<f32>(0.0, 1.0, 0.0), is_upright != 0u);
}

// Unit vector of the part of a lean (on the map) that is perpendicular to the axis of the blades (Bakay, section 3.2); zero for no lean.
fn wind_across(axis: vec3<f32>, lean: vec2<f32>) -> vec3<f32> {
    let across = vec3<f32>(lean.x, 0.0, lean.y) / max(length(lean), 1e-4);
    let along = across - dot(across, axis) * axis;
    return along / max(length(along), 1e-4);
}

// Wind over the ground (m/s), behind obstacles, as grass follows it: at once when it rises, slowly when it falls. The gusts of the last second are those that the wind has
// carried past.
fn wind_held(ground: vec3<f32>) -> vec2<f32> {
    let resolved = sheltered_at(ground, 0.0);
    let now = resolved + gust_at(ground.xz);
    let passed_m = frame.wind_direction * (frame.mean_wind_m_per_s * RELEASE_SECS * 0.5);
    var held = now;
    for (var i = 1; i <= 2; i++) {
        let before = mix(now, resolved + gust_at(ground.xz + f32(i) * passed_m), select(0.61, 0.37, i == 2));
        held = select(held, before, dot(before, before) > dot(held, held));
    }
    return held;
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn settle_turf(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= TILE_VERTICES {
        return;
    }
    let vertex = tile_vertex(tiles[id.y], id.x);
    let p = vertex.p;
    let ground = vec3<f32>(p.x, ground_height(p), p.y);
    let distance_m = distance(ground, frame.eye_m);
    let normal = ground_normal(p);
    let kind = kinds_blended(p);

    let height = kind.height_m * (1.0 + frame.height_variation) * fed(p) * mix(0.86, 1.10, noise(p / 3.1).g);
    let lean = lean_in(ground, field_level(distance_m), wind_held(ground), kind.wind_bend_rad);
    let lean_rad = length(lean);
    let axis = upright_axis(normal, shells.is_upright);
    let tilt = tilt_of(lean_rad);

    var growth = smoothstep(0.05, 0.75, grass_fraction(p)) * (1.0 - smoothstep(frame.far_fade_from_m, frame.far_end_m, distance_m));
    if shells.is_alone + u32(runtime_zero(height)) == 0u {
        growth *= smoothstep(frame.blades_fade_from_m, frame.blades_end_m, distance_m);
    }
    let tint = grass_tint(p) * (0.80 + 0.42 * smoothstep(0.08, 0.55, lean_rad));
    let light = cloud_light(p) * sun_visible(ground + axis * height * 0.6);
    var turf: Turf;
    turf.root_m = ground;
    turf.height_m = height;
    turf.normal = normal;
    turf.tilt_rad = tilt.x;
    turf.wind_direction = wind_across(axis, lean);
    turf.wind_intensity = tilt.y;
    turf.root_rgb = kind.root_rgb * tint;
    turf.sunlight = light;
    turf.tip_rgb = kind.tip_rgb * tint * trodden(lean_rad);
    turf.growth = growth;
    turf.axis = axis;
    turf.morph = vertex.morph;
    settled[id.y * TILE_VERTICES + id.x] = turf;
}

struct Sheet {
    @builtin(position) position: vec4<f32>,
    // Position (m); fraction of sunlight.
    @location(0) p: vec4<f32>,
    // X and Z of the root (m); height of the tallest blade (m); fraction of it that grass has there.
    @location(1) root: vec4<f32>,
    // From the next layer to this one (m); progress of the transition to fewer layers.
    @location(2) segment: vec4<f32>,
    @location(3) normal: vec3<f32>,
    @location(4) low: vec3<f32>,
    @location(5) high: vec3<f32>,
    // Relative height of this layer, and drop to the next; drop to the one after, relative to that; 1 if the layer ends.
    @location(6) @interpolate(flat) layer: vec4<f32>,
}

@vertex
fn vs(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Sheet {
    let drawn = tile_layers[instance];
    let turf = turfs[(drawn.tile_and_layer >> 8u) * TILE_VERTICES + index];
    let layer = f32(drawn.tile_and_layer & 255u);
    let segments = f32(max(shells.segments, 1u));
    let below = f32(drawn.to_next);
    let profile = shells.stiffness_profile;
    let under = layer_place(turf.tilt_rad, turf.wind_intensity, profile, layer - below, segments);
    var at = under;
    if has_profile {
        at += segments_between(turf.tilt_rad, turf.wind_intensity, profile, layer - below, layer, segments);
    } else {
        at = layer_place(turf.tilt_rad, turf.wind_intensity, profile, layer, segments);
    }
    let height = turf.height_m;
    var p = turf.root_m + height * (at.x * turf.axis + at.y * turf.wind_direction);
    // The single layer of the lowest setting is just above the ground.
    p.y += select(0.0, 0.004, drawn.tile_and_layer % 256u == 0u);
    var out: Sheet;
    out.position = frame.projection_from_world * vec4<f32>(p, 1.0);
    out.p = vec4<f32>(p, turf.sunlight);
    out.root = vec4<f32>(turf.root_m.xz, height, turf.growth);
    out.segment = vec4<f32>(height * ((at.x - under.x) * turf.axis + (at.y - under.y) * turf.wind_direction), turf.morph);
    out.normal = turf.normal;
    out.low = turf.root_rgb;
    out.high = turf.tip_rgb;
    out.layer = vec4<f32>(layer / segments, below / segments, f32(drawn.to_second) / max(below, 1.0), f32(drawn.ends));
    return out;
}

// A sample of the texture at a scale: coordinates and their change down to the next layer, mip level, weight of its heights, and deflection
// of blades here and at the next layer at the height of the tallest.
struct Grain {
    uv: vec2<f32>,
    run: vec2<f32>,
    level: f32,
    fraction: f32,
    aside: vec4<f32>,
}

// The texture enlarged by 2^`times`, turned each time so that no two scales look alike.
fn grain_of(p: vec2<f32>, run: vec2<f32>, aside: vec4<f32>, times: f32, level: f32, fraction: f32) -> Grain {
    let angle = 2.4 * times;
    let size = exp2(-times) / shells.texture_m;
    let turn = mat2x2<f32>(vec2<f32>(cos(angle), sin(angle)), vec2<f32>(-sin(angle), cos(angle))) * size;
    return Grain(turn * p, turn * run, level - times + 0.8 * min(times, 1.0), fraction, vec4<f32>(turn * aside.xy, turn * aside.zw));
}

fn cross_section(grain: Grain, u: f32, high: f32) -> vec4<f32> {
    let found = textureSampleLevel(dots, repeated, grain.uv + grain.run * u + mix(grain.aside.xy, grain.aside.zw, u) * (high * high), grain.level);
    return vec4<f32>(found.rgb, found.a * grain.fraction);
}

// Light on a blade at fraction `up` of its length and relative height `high`, from its tangent alone: the normal is the one across the
// tangent that faces the sun most (Bakay, section 3.3, after Banks and Kajiya & Kay), the self-shadow a ramp (section 3.3.3).
fn light_on(sheet: Sheet, dot_rgb: vec3<f32>, up: f32, high: f32, view: vec3<f32>) -> vec3<f32> {
    let tangent = normalize(sheet.segment.xyz);
    let sun = frame.toward_sun;
    let facing = sun - dot(tangent, sun) * tangent;
    let normal = normalize(facing * 0.5 + sheet.normal * 0.7 - view * 0.35);
    let shadow = mix(shells.root_light, 1.0, high);
    let albedo = plant_color(sheet.low, sheet.high, up, 0.5) * dot_rgb * 1.8;
    return grass_light(albedo, normal, tangent, view, sheet.p.w, shadow) + grass_lamps(albedo, normal, tangent, view, sheet.p.xyz, shadow);
}

struct Shade {
    @location(0) color: vec4<f32>,
    @builtin(sample_mask) samples: u32,
}

// Sample mask of a pixel with that coverage; with one sample, whether it is covered.
fn mask_of(covered: f32, threshold: f32) -> u32 {
    let count = shells.samples;
    let filled = u32(clamp(covered, 0.0, 1.0) * f32(count) + 0.5);
    let all = (1u << count) - 1u;
    let turn = u32(threshold * f32(count));
    let bits = (1u << filled) - 1u;
    return ((bits << turn) | (bits >> (count - turn))) & all;
}

@fragment
fn fs(sheet: Sheet) -> Shade {
    let threshold = gradient_noise(sheet.position.xy);
    let merges = threshold < sheet.segment.w;
    if merges && sheet.layer.w > 0.5 {
        discard;
    }
    let to = sheet.p.xyz - frame.eye_m;
    let distance_m = length(to);
    let view = to / distance_m;

    // Intersection with the layers below: the root moves along the ground by `run` down to the next.
    let falls = dot(view, sheet.normal);
    let slope = select(max(falls, 0.04), min(falls, -0.04), falls < 0.0);
    let reach = select(1.0, sheet.layer.z, merges);
    let run = (sheet.segment.xyz - view * (dot(sheet.segment.xyz, sheet.normal) / slope)).xz * reach;

    let px_m = distance_m * frame.pixel_rad;
    let level = max(log2(1.4 * px_m / shells.texel_m), 0.0);
    let over = max(level - shells.last_level, 0.0);
    let times = floor(over);
    let next = smoothstep(0.4, 1.0, over - times);
    let afar = smoothstep(1.0, 4.0, level);
    let clump = noise(sheet.root.xy / CLUMP_M);
    let clump_below = noise((sheet.root.xy + run) / CLUMP_M);
    // Bare patches have ragged borders.
    let growth = clamp(2.2 * sheet.root.w - 1.2 * clump.b, 0.0, 1.0);
    let aside = (vec4<f32>(clump.rg, clump_below.rg) - 0.5) * (REST_DEFLECTION * sheet.root.z * (1.0 - afar));
    let fine = grain_of(sheet.root.xy, run, aside, times, level, growth * min(2.0 - 2.0 * next, 1.0));
    let coarse = grain_of(sheet.root.xy, run, aside, times + 1.0, level, growth * min(2.0 * next, 1.0));

    // One slice per blade width along the ray.
    let width_m = max(px_m, shells.texel_m * 2.5);
    let slices = clamp(ceil(length(run) / width_m), 1.0, f32(shells.slice_limit));
    let jitter = select(0.0, 0.6 * threshold, slices > 1.0);
    let falls_by = sheet.layer.y * reach;
    // Width of a pixel over the distance in which a blade tapers from middle to edge, in heights.
    let sharpness = max(SHELL_BLADE_PX * exp2(max(level - shells.last_level, 0.0)) * shells.texel_m / px_m, 4.0);
    var found = vec4<f32>(0.0);
    var high = 0.0;
    var covered = 0.0;
    for (var slice = 0.0; slice < slices && covered <= 0.0; slice += 1.0) {
        let u = (slice + jitter) / slices;
        high = sheet.layer.x - falls_by * u;
        found = cross_section(fine, u, high);
        if next > 0.0 {
            let other = cross_section(coarse, u, high);
            found = select(found, other, vec4<bool>(other.a > found.a));
        }
        covered = select(0.0, 0.5 + (found.a - high) * sharpness, found.a > 0.03);
    }
    let mask = mask_of(covered, threshold);
    if mask == 0u {
        discard;
    }
    // Blades too small to be seen are averaged.
    let own = mix(found.rgb, vec3<f32>(0.5), 0.6 * afar) * (0.8 + 0.4 * clump.b);
    let color = light_on(sheet, own, min(high / found.a, 1.0), mix(high, MEAN_HEIGHT, 0.85 * afar), view);
    return Shade(vec4<f32>(hazed(color, sheet.p.xyz), 1.0), mask);
}
