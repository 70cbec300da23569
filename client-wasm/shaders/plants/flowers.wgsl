// Flower heads of six kinds: near ones as a ring of petals around a disc, or as a square with a texture; others as a disc alone. One instance is 64 heads as one indexed
// list.

import package::constants::{
    DISC_VERTICES, FLOWER_BASE_RGB, FLOWER_DISC_M, FLOWER_DISC_RGB, FLOWER_KINDS, FLOWER_PETAL_M, FLOWER_PETAL_WIDTH, FLOWER_PETALS,
    FLOWER_RISE_RAD, FLOWER_SQUARE, FLOWER_TIP_RGB, HEAD_VERTICES, PETAL_ACROSS, PETAL_ALONG, PETAL_FLATTENS, PETAL_VERTICES, PETALS,
    SQUARE_VERTICES, TAU,
};
import package::inputs::frame::{clamped, frame};
import package::inputs::lamps::lamps_on;
import package::land_and_sky::sky_light::ambient;
import package::plants::drawn_blade::Blade;
import package::plants::strip_list::{is_listed, listed, number_of};

const RIM_VERTICES: u32 = DISC_VERTICES - 1u;
// Radius of a disc with the same coverage as the petals, relative to their length.
const DISC_FRACTION: f32 = 0.8;

struct Flower {
    // Number of petals.
    petals: f32,
    // Their length (m).
    length_m: f32,
    // Their width relative to the length.
    width: f32,
    // Angle by which they rise (rad).
    rise_rad: f32,
    // Their colour at the base and at the tip.
    base: vec3<f32>,
    tip: vec3<f32>,
    // Colour of the disc.
    disc_rgb: vec3<f32>,
    // Radius of the disc (m).
    disc_m: f32,
}

fn kind_of(fraction: f32) -> Flower {
    let kind = u32(fraction * f32(FLOWER_KINDS));
    var petals = FLOWER_PETALS;
    var length_m = FLOWER_PETAL_M;
    var width = FLOWER_PETAL_WIDTH;
    var rise_rad = FLOWER_RISE_RAD;
    var base = FLOWER_BASE_RGB;
    var tip = FLOWER_TIP_RGB;
    var disc_rgb = FLOWER_DISC_RGB;
    var disc_m = FLOWER_DISC_M;
    return Flower(
        petals[kind], length_m[kind], width[kind], rise_rad[kind], base[kind], tip[kind], disc_rgb[kind], disc_m[kind],
    );
}

struct Petal {
    @builtin(position) position: vec4<f32>,
    @location(0) color: vec3<f32>,
}

// Position and axes of a head: up along its stem, tilted a little towards the sun.
struct Head {
    at: vec3<f32>,
    axis: vec3<f32>,
    right: vec3<f32>,
    ahead: vec3<f32>,
    // Relative to its kind.
    size: f32,
    kind: Flower,
}

fn head_of(stem: Blade) -> Head {
    var head: Head;
    head.at = stem.root_m + stem.tip_m;
    let tangent = normalize(stem.tip_m - stem.middle_m);
    head.axis = normalize(tangent + frame.toward_sun * 0.45 + vec3<f32>(0.0, 0.35, 0.0));
    head.right = normalize(cross(head.axis, vec3<f32>(0.31, 0.17, 0.93)));
    head.ahead = cross(head.right, head.axis);
    head.size = stem.width * 1.7 * (1.0 - smoothstep(frame.blades_fade_from_m, frame.blades_end_m, distance(head.at, frame.eye_m)));
    head.kind = kind_of(clamp(stem.kind_and_hue, 0.0, 0.999));
    return head;
}

fn hidden() -> Petal {
    var out: Petal;
    out.position = vec4<f32>(0.0, 0.0, 0.0, 1.0);
    return out;
}

fn shown(stem: Blade, p: vec3<f32>, normal: vec3<f32>, albedo: vec3<f32>) -> Petal {
    return Petal(frame.projection_from_world * vec4<f32>(p, 1.0), lit(stem, p, normal, albedo));
}

@vertex
fn vs(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Petal {
    let number = number_of(index, instance, HEAD_VERTICES);
    if !is_listed(number) {
        return hidden();
    }
    let local = index % HEAD_VERTICES;
    let stem = listed(number);
    let head = head_of(stem);
    let kind = head.kind;

    var p: vec3<f32>;
    var normal = head.axis;
    var albedo: vec3<f32>;
    if local < PETALS * PETAL_VERTICES {
        let petal = local / PETAL_VERTICES;
        let corner = local % PETAL_VERTICES;
        let petals = kind.petals;
        let is_there = f32(petal) < petals;
        let angle = (f32(petal) + stem.side_rad) / petals * TAU;
        let out_dir = head.right * cos(angle) + head.ahead * sin(angle);
        let across = cross(head.axis, out_dir);
        let rise = kind.rise_rad;
        // Root, two at the middle, two at the end.
        var alongs = PETAL_ALONG;
        var acrosses = PETAL_ACROSS;
        let t = alongs[corner];
        let w = acrosses[corner];
        let curl = rise * (1.0 - PETAL_FLATTENS * t);
        let along = out_dir * cos(curl) + head.axis * sin(curl);
        let reach = select(0.0, kind.length_m * head.size, is_there);
        p = head.at + along * (reach * t) + across * (reach * w * kind.width);
        normal = normalize(head.axis * cos(curl) - out_dir * sin(curl) + across * w * 0.6);
        albedo = mix(kind.base, kind.tip, t);
    } else {
        let rim = local - PETALS * PETAL_VERTICES;
        let radius = select(kind.disc_m * head.size, 0.0, rim == 0u);
        let angle = f32(rim) / f32(RIM_VERTICES) * TAU;
        p = head.at + head.axis * (head.size * (0.004 + select(0.0, kind.disc_m * 0.5, rim == 0u)));
        p += (head.right * cos(angle) + head.ahead * sin(angle)) * radius;
        albedo = kind.disc_rgb;
    }
    return shown(stem, p, normal, albedo);
}

// Light from a petal or disc to the eye.
fn lit(stem: Blade, p: vec3<f32>, normal: vec3<f32>, albedo: vec3<f32>) -> vec3<f32> {
    return albedo * light_on(stem, p, normal) * stem.air.a + stem.air.rgb;
}

// Light that a white petal or disc sends to the eye.
fn light_on(stem: Blade, p: vec3<f32>, normal: vec3<f32>) -> vec3<f32> {
    let view = normalize(p - frame.eye_m);
    let light = stem.sunlight;
    let facing = dot(normal, frame.toward_sun);
    let diffuse = clamp((facing + 0.3) / 1.3, 0.0, 1.0);
    let through = 0.35 * max(dot(view, frame.toward_sun), 0.0) * clamp(0.5 - facing, 0.0, 1.0);
    return frame.sun_rgb * light * (diffuse + through) * 0.85 + ambient(normal) + lamps_on(p, normal, 0.3);
}

// Far head as a disc: a centre and six vertices on its rim.
@vertex
fn vs_disc(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Petal {
    let number = number_of(index, instance, DISC_VERTICES);
    if !is_listed(number) {
        return hidden();
    }
    let rim = index % DISC_VERTICES;
    let stem = listed(number);
    let head = head_of(stem);
    let kind = head.kind;
    // The more the petals rise, the narrower and deeper the head.
    let reach = DISC_FRACTION * kind.length_m * head.size * select(cos(0.7 * kind.rise_rad), 0.0, rim == 0u);
    let rise = select(sin(0.7 * kind.rise_rad) * DISC_FRACTION * kind.length_m * head.size, 0.0, rim == 0u);
    let angle = f32(rim) / f32(RIM_VERTICES) * TAU;
    let p = head.at + (head.right * cos(angle) + head.ahead * sin(angle)) * reach + head.axis * rise;
    let albedo = select(mix(kind.base, kind.tip, 0.7), mix(kind.base, kind.disc_rgb, 0.6), rim == 0u);
    return shown(stem, p, head.axis, albedo);
}

// Largest tilt of a textured flower from upright.
const TILT: f32 = 0.45;

struct Square {
    @builtin(position) position: vec4<f32>,
    // Light on a white square that reaches the eye, and the light of the air before it.
    @location(0) light: vec3<f32>,
    @location(1) air: vec3<f32>,
    // Place in the texture, with the squares of all kinds side by side.
    @location(2) place: vec2<f32>,
}

// Near head as a square across the upward direction, tilted at random and by the stem (Zhang, section 3.3).
@vertex
fn vs_square(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Square {
    let number = number_of(index, instance, SQUARE_VERTICES);
    var out: Square;
    if !is_listed(number) {
        out.position = vec4<f32>(0.0, 0.0, 0.0, 1.0);
        return out;
    }
    let corner = vec2<f32>(f32(index % 2u), f32(index % SQUARE_VERTICES / 2u)) * 2.0 - 1.0;
    let stem = listed(number);
    let head = head_of(stem);
    let kind = clamp(stem.kind_and_hue, 0.0, 0.999) * f32(FLOWER_KINDS);
    let own = fract(vec2<f32>(kind * 71.3, kind * 193.7)) * 2.0 - 1.0;
    let stem_lean = normalize(stem.tip_m - stem.middle_m).xz;
    let axis = normalize(vec3<f32>(TILT * own.x + stem_lean.x, 1.0, TILT * own.y + stem_lean.y));
    let right = normalize(cross(axis, vec3<f32>(0.31, 0.17, 0.93)));
    let turn = stem.side_rad;
    let across = right * cos(turn) + cross(right, axis) * sin(turn);
    let half_m = 0.5 * FLOWER_SQUARE * head.kind.length_m * head.size;
    let p = head.at + (across * corner.x + cross(across, axis) * corner.y) * half_m;
    out.position = frame.projection_from_world * vec4<f32>(p, 1.0);
    out.light = light_on(stem, p, axis) * stem.air.a;
    out.air = stem.air.rgb;
    out.place = vec2<f32>((floor(kind) + 0.5 + 0.5 * corner.x) / f32(FLOWER_KINDS), 0.5 + 0.5 * corner.y);
    return out;
}

// Square roots of the linear colours of the flowers, and their coverage.
@group(1) @binding(3) var flowers: texture_2d<f32>;

@fragment
fn fs_square(square: Square) -> @location(0) vec4<f32> {
    let texel = textureSample(flowers, clamped, square.place);
    if texel.a < 0.5 {
        discard;
    }
    return vec4<f32>(texel.rgb * texel.rgb * square.light + square.air, 1.0);
}

@fragment
fn fs(petal: Petal) -> @location(0) vec4<f32> {
    return vec4<f32>(petal.color, 1.0);
}
