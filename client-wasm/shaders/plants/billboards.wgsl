// Clumps of far plants: six rectangles about a vertical axis (Zhang, section 4.1). One instance is 32 clumps.

import package::constants::{CLUMP_FADE_SPREAD_M, CLUMP_PLANTS, CLUMPS, TAU, WORKGROUP_SIZE};
import package::inputs::bend_atlas::{bend_at, far_lean, field_level, field_fraction, lean_of_bend, lean_of_field, trailing_lean};
import package::inputs::frame::{frame, repeated};
import package::inputs::grass_kinds::{kind_at, kinds};
import package::inputs::lamps::lamps_on;
import package::inputs::random::dither_at;
import package::inputs::shadows::sun_visible;
import package::inputs::sward_shade::shade_at;
import package::inputs::wind::{gust_at, lean_of_wind, resolved_at};
import package::land_and_sky::clouds::cloud_light;
import package::land_and_sky::grass_color::grass_tint;
import package::land_and_sky::grass_light::sun_in_grass;
import package::land_and_sky::ground::{fed, grass_fraction, grass_fraction_over, ground_height, ground_normal};
import package::land_and_sky::haze::hazed;
import package::land_and_sky::sky_light::ambient;
import package::land_and_sky::snow::with_snow;
import package::land_and_sky::sward::{MEAN_STRAW, blade_color, contrast, sward_color};
import package::plants::force_field::{forces_at, sheltered};
import package::plants::nearness::nearness;
import package::plants::opacity::LEAST_OPACITY;
import package::plants::weighted::{Weighted, weighted};
import package::uniforms::ClumpList;

struct Clump {
    // Axis, X and Z (m).
    axis_m: vec2<f32>,
    // Length of a rectangle (m).
    length_m: f32,
    // Random number 0..1.
    random: f32,
}

// State of a clump, the same for all its vertices.
struct ClumpPose {
    // Mean height of its blades (m).
    height_m: f32,
    // Number of segments.
    segments: f32,
    // Opacity of the clump, 0..1.
    shown: f32,
    // Height relative to that of its plants: clumps sink into the ground where they end.
    risen: f32,
    // Lit colour of the plants' roots.
    root_color: vec3<f32>,
    // Index of the kind of its plants.
    kind: u32,
    // Lit colour of their tips.
    tip_color: vec3<f32>,
    // How far it bends as a whole, 0..1.
    straight: f32,
    // Light on petals.
    petal_light: vec3<f32>,
}

@group(1) @binding(0) var<storage, read> clumps: array<Clump>;
@group(1) @binding(1) var<uniform> list: ClumpList;
@group(1) @binding(2) var tufts: texture_2d<f32>;
@group(1) @binding(3) var<storage, read> poses: array<ClumpPose>;
@group(1) @binding(4) var<storage, read_write> poses_out: array<ClumpPose>;
// Keys and numbers of clumps far to near, those of one segment first: input and output of the sort.
@group(1) @binding(5) var<storage, read_write> keyed: array<vec2<u32>>;
@group(1) @binding(6) var<storage, read> in_order: array<vec2<u32>>;
// Tops of the segments of the plants that each clump joins, relative to the foot of the plant (m), and the height of the land at the foot (m).
@group(1) @binding(7) var<storage, read> joints: array<vec4<f32>>;
@group(1) @binding(8) var<storage, read_write> joints_out: array<vec4<f32>>;

// Width and height of the texture's pattern (m per m of mean blade height).
const PATTERN_WIDTH: f32 = 4.0;
const PATTERN_HEIGHT: f32 = 1.25;

// Foot of one of the plants that a clump joins: 0 is on its axis, 1 to 6 are at the outer ends of its rectangles.
fn plant_foot(clump: Clump, plant: u32) -> vec2<f32> {
    let angle = (f32(plant) - 1.0) / 6.0 * TAU + clump.random * TAU;
    return clump.axis_m + vec2<f32>(cos(angle), sin(angle)) * select(clump.length_m, 0.0, plant == 0u);
}

// Index of the lowest joint of a plant. Clumps of several segments come first.
fn first_joint(number: u32, plant: u32) -> u32 {
    let segments = select(1u, list.several_segments, number < list.several);
    let before = select(list.several * CLUMP_PLANTS * list.several_segments, 0u, number < list.several);
    let first = select(list.several, 0u, number < list.several);
    return before + ((number - first) * CLUMP_PLANTS + plant) * segments;
}

// Wind over the ground on far plants (m/s). Its deviation from the mean wind grows in proportion to the distance beyond that at which clumps begin,
// so that they still move visibly (Zhang, section 4.2).
fn far_wind(ground: vec3<f32>, distance_m: f32) -> vec2<f32> {
    let beyond = max(distance_m / list.raised_from_m, 1.0) - 1.0;
    let resolved = resolved_at(ground, 0.0).xz;
    let moving = resolved + (resolved - list.mean_wind_m_per_s) * beyond;
    return sheltered(moving, forces_at(ground.xz, 0.0).xy) + gust_at(ground.xz) * (1.0 + beyond);
}

// Bends the plants that a clump joins, each by the wind and the bend field at its own foot. They tilt the lowest segment; the upper ones follow its
// earlier leans (Chen & Johan, section 4.5). With distance all straighten into one line. Tops stay above the ground.
@compute @workgroup_size(WORKGROUP_SIZE)
fn bend_plants(@builtin(global_invocation_id) id: vec3<u32>) {
    let number = id.x / CLUMP_PLANTS;
    if number >= list.count || poses_out[number].shown <= 0.0 {
        return;
    }
    let kind = kinds.list[poses_out[number].kind];
    let straight = poses_out[number].straight;
    let segments = u32(poses_out[number].segments);
    let p = plant_foot(clumps[number], id.x % CLUMP_PLANTS);
    let ground = vec3<f32>(p.x, ground_height(p), p.y);
    let height = kind.height_m * PATTERN_HEIGHT * fed(p) * poses_out[number].risen;
    let distance_m = distance(ground, frame.eye_m);
    let level = field_level(distance_m);
    let fraction = field_fraction(p);
    let now = bend_at(p, level, 0);
    let steady = lean_of_wind(far_wind(ground, distance_m), kind.wind_bend_rad) + far_lean(p, level, fraction);
    let lowest = steady + lean_of_bend(now) * fraction;
    let curl = (1.0 - straight) * (1.0 - smoothstep(0.5, 1.3, length(lowest)));
    let first = first_joint(number, id.x % CLUMP_PLANTS);
    var at = vec3<f32>(0.0);
    for (var i = 0u; i < segments; i++) {
        var lean = lowest;
        if i > 0u && fraction > 0.0 && straight < 1.0 {
            let secs = kind.lag_secs * f32(i) / f32(segments - 1u);
            lean = mix(steady + trailing_lean(p, level, now, kind, secs) * fraction, lowest, straight);
        }
        if segments > 1u {
            lean *= 1.0 + curl * (0.7 * f32(i) / f32(segments - 1u) - 0.35);
        }
        let tilt = min(length(lean), 1.45);
        let aside = lean / max(length(lean), 1e-4) * sin(tilt);
        at += vec3<f32>(aside.x, cos(tilt), aside.y) * (height / f32(segments));
        at.y = max(at.y, ground_height(p + at.xz) - ground.y);
        joints_out[first + i] = vec4<f32>(at, ground.y);
    }
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn place(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= list.count {
        return;
    }
    let clump = clumps[id.x];
    let root = clump.axis_m;
    // Kinds mix where they meet.
    let number = kind_at(root + (vec2<f32>(clump.random, fract(clump.random * 7.3)) - 0.5) * 0.9);
    let kind = kinds.list[number];
    let ground = vec3<f32>(root.x, ground_height(root), root.y);
    let distance_m = distance(ground, frame.eye_m);
    let level = field_level(distance_m);
    let lean = lean_of_field(root, level) + lean_of_wind(far_wind(ground, distance_m), kind.wind_bend_rad);
    // Clumps fade in as single plants fade out (Zhang, section 6.1).
    let fade_in = smoothstep(frame.blades_fade_from_m, frame.blades_end_m, distance_m + (clump.random - 0.5) * (2.0 * CLUMP_FADE_SPREAD_M));
    let fade_out = 1.0 - smoothstep(frame.far_fade_from_m, frame.far_end_m, distance_m);
    // Seen from above, sparse clumps would look like stars: the colour of the ground replaces them.
    let down = smoothstep(0.09, 0.22, dot(frame.eye_m - ground, ground_normal(root)) / max(distance_m, 1e-3));
    let flat_fraction = down * smoothstep(frame.blades_end_m * 0.9, frame.blades_end_m * 1.6, distance_m);
    var pose: ClumpPose;
    pose.kind = number;
    pose.risen = mix(0.35, 1.0, fade_out) * (1.0 - flat_fraction);
    pose.straight = smoothstep(list.straightens_m, list.straight_m, distance_m);
    pose.height_m = kind.height_m;
    pose.segments = select(1.0, min(kind.segments, f32(list.several_segments)), id.x < list.several);
    // Clumps that cross a gap are cut by `painted`; those that no grass reaches are left out.
    let covered = grass_fraction_over(root, 2.0 * clump.length_m);
    pose.shown = fade_in * min(fade_out * 4.0, 1.0) * select(0.0, 1.0, covered > 0.0) * step(0.05, pose.risen);
    let height = kind.height_m * PATTERN_HEIGHT * fed(root);
    let light = cloud_light(root) * sun_visible(ground + vec3<f32>(0.0, height * 0.6, 0.0));
    let p = ground + vec3<f32>(0.0, height * pose.risen * 0.5, 0.0);
    let view = normalize(p - frame.eye_m);
    let normal = normalize(ground_normal(root) - view * 0.45 + vec3<f32>(lean.x, 0.0, lean.y) * 0.7);
    let tangent = normalize(vec3<f32>(lean.x, 1.0, lean.y));
    let tilt = min(length(lean), 1.45);
    let tint = grass_tint(root);
    let shade = shade_at(root);
    // Near its root a clump has the colour of the grass around it.
    let afar = sward_color(ground, ground_normal(root), kind, tint, lean, view, light, shade);
    pose.root_color = hazed(with_snow(afar, ground, ground_normal(root), kind, view, light, shade), p);
    let lit = light * sun_in_grass(0.9, kind, shade, 0.9);
    let top = blade_color(kind, tint, 0.95, 0.9, 0.5, MEAN_STRAW, tilt, normal, tangent, view, p, lit);
    pose.tip_color = hazed(mix(afar, top, 0.35 + 0.65 * contrast(distance_m)), p);
    pose.petal_light = frame.sun_rgb * light * 0.6 + ambient(normal) + lamps_on(p, normal, 0.3);
    poses_out[id.x] = pose;
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn key_clumps(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < list.count {
        let root = clumps[id.x].axis_m;
        let near = nearness(distance(vec3<f32>(root.x, ground_height(root), root.y), frame.eye_m));
        keyed[id.x] = vec2<u32>((u32(id.x < list.several) << 15u) | near, id.x);
    }
}

struct Rectangle {
    @builtin(position) position: vec4<f32>,
    @location(0) uv: vec2<f32>,
    // As in `ClumpPose`.
    @location(1) root_color: vec3<f32>,
    @location(2) tip_color: vec3<f32>,
    @location(3) petal_light: vec3<f32>,
    @location(4) shown: f32,
    // From the eye (m).
    @location(5) distance_m: f32,
    // Foot of the plants at a point of the rectangle (m).
    @location(6) foot_m: vec2<f32>,
}

// Corner of one of the six rectangles of a clump: two per row, lowest row first.
fn corner_of(number: u32, side: u32, corner: u32) -> Rectangle {
    var out: Rectangle;
    out.position = vec4<f32>(0.0, 0.0, 0.0, 1.0);
    if poses[number].shown <= 0.0 {
        return out;
    }
    let clump = clumps[number];
    let segments = poses[number].segments;
    let outward = f32(corner & 1u);
    // Rows above the topmost segment collapse onto its top.
    let row = min(corner >> 1u, u32(segments));
    let plant = select(0u, side + 1u, (corner & 1u) == 1u);
    let first = first_joint(number, plant);
    let foot = plant_foot(clump, plant);
    var p = vec3<f32>(foot.x, joints[first].w - 0.03, foot.y);
    if row > 0u {
        p += joints[first + row - 1u].xyz;
    }
    let upward = f32(row) / segments;
    out.root_color = poses[number].root_color;
    out.tip_color = poses[number].tip_color;
    out.petal_light = poses[number].petal_light;
    out.shown = poses[number].shown;
    out.uv = vec2<f32>(
        clump.random * 7.0 + f32(side) * 0.37 + outward * clump.length_m / (PATTERN_WIDTH * poses[number].height_m),
        1.0 - upward,
    );
    out.position = frame.projection_from_world * vec4<f32>(p, 1.0);
    out.distance_m = distance(p, frame.eye_m);
    out.foot_m = foot;
    return out;
}

fn hidden() -> Rectangle {
    var out: Rectangle;
    out.position = vec4<f32>(0.0, 0.0, 0.0, 1.0);
    return out;
}

@vertex
fn vs(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Rectangle {
    let rows = select(1u, list.several_segments, instance < list.several_instances);
    let corners = 2u * (rows + 1u);
    let number = instance * CLUMPS + index / (6u * corners);
    if number >= list.count {
        return hidden();
    }
    return corner_of(number, index / corners % 6u, index % corners);
}

// Instances of clumps of one segment come first.
@vertex
fn vs_in_order(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Rectangle {
    let single = list.count - list.several;
    let single_instances = (single + CLUMPS - 1u) / CLUMPS;
    let is_single = instance < single_instances;
    let rows = select(list.several_segments, 1u, is_single);
    let corners = 2u * (rows + 1u);
    let first = select(single + (instance - single_instances) * CLUMPS, instance * CLUMPS, is_single);
    let at = first + index / (6u * corners);
    if at >= select(list.count, single, is_single) {
        return hidden();
    }
    let number = in_order[at].y;
    // First the rectangle that points away from the eye, then those on both sides of it, and so on.
    let clump = clumps[number];
    let away = clump.axis_m - frame.eye_m.xz;
    let farthest = round((atan2(away.y, away.x) / TAU - clump.random) * 6.0);
    let aside = array<f32, 6>(0.0, 1.0, -1.0, 2.0, -2.0, 3.0)[index / corners % 6u];
    return corner_of(number, u32(farthest + aside + 18.0) % 6u, index % corners);
}

fn painted(r: Rectangle) -> vec4<f32> {
    // Texture: height along the plant, hue, fraction of petals, coverage.
    let texel = textureSample(tufts, repeated, vec2<f32>(r.uv.x, clamp(r.uv.y, 0.01, 0.99)));
    var alpha = clamp((texel.a - 0.5) / max(fwidth(texel.a), 0.0001) + 0.5, 0.0, 1.0);
    // No plant stands where the covering map has none (Zhang, section 5.5.2).
    if alpha > 0.0 {
        alpha *= grass_fraction(r.foot_m);
    }
    let up = 1.0 - r.uv.y;
    let t = texel.r * smoothstep(-0.15, 0.75, up);
    let color = mix(r.root_color, r.tip_color, t * t);
    let petal = select(vec3<f32>(0.85, 0.80, 0.72), vec3<f32>(0.80, 0.58, 0.06), texel.g > 0.5);
    let flowers = texel.b * step(0.01, frame.flowers_per_m2);
    return vec4<f32>(mix(color, petal * r.petal_light, flowers), alpha * r.shown);
}

@fragment
fn fs(r: Rectangle) -> @location(0) vec4<f32> {
    let paint = painted(r);
    if paint.a <= dither_at(r.position.xy) {
        discard;
    }
    return vec4<f32>(paint.rgb, 1.0);
}

@fragment
fn fs_soft(r: Rectangle) -> @location(0) vec4<f32> {
    let paint = painted(r);
    if paint.a < LEAST_OPACITY {
        discard;
    }
    return paint;
}

@fragment
fn fs_weighted(r: Rectangle) -> Weighted {
    let paint = painted(r);
    return weighted(paint.rgb, paint.a, r.distance_m, 1.0 - r.uv.y);
}
