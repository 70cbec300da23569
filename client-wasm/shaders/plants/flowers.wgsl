// Flower heads of six kinds: near ones as a ring of petals around a disc, others as a disc alone. One instance is 64 heads as one indexed
// list.

import package::constants::{DISC_VERTICES, HEAD_VERTICES, PETAL_VERTICES, PETALS, TAU};
import package::inputs::frame::frame;
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
    switch u32(fraction * 6.0) {
        case 0u: { return Flower(12.0, 0.026, 0.34, 0.18, vec3<f32>(0.80, 0.80, 0.76), vec3<f32>(0.95, 0.95, 0.93), vec3<f32>(0.85, 0.52, 0.03), 0.010); }
        case 1u: { return Flower(5.0, 0.030, 1.05, 0.75, vec3<f32>(0.28, 0.015, 0.01), vec3<f32>(0.86, 0.075, 0.02), vec3<f32>(0.03, 0.02, 0.02), 0.008); }
        case 2u: { return Flower(9.0, 0.024, 0.50, 0.45, vec3<f32>(0.09, 0.08, 0.42), vec3<f32>(0.16, 0.25, 0.88), vec3<f32>(0.18, 0.05, 0.30), 0.009); }
        case 3u: { return Flower(5.0, 0.018, 0.95, 0.55, vec3<f32>(0.90, 0.58, 0.02), vec3<f32>(0.98, 0.80, 0.06), vec3<f32>(0.75, 0.55, 0.05), 0.007); }
        case 4u: { return Flower(12.0, 0.022, 0.30, 1.05, vec3<f32>(0.62, 0.20, 0.46), vec3<f32>(0.84, 0.46, 0.72), vec3<f32>(0.66, 0.30, 0.50), 0.012); }
        default: { return Flower(6.0, 0.026, 0.55, 0.30, vec3<f32>(0.46, 0.28, 0.72), vec3<f32>(0.70, 0.56, 0.92), vec3<f32>(0.85, 0.70, 0.20), 0.006); }
    }
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
        let t = array<f32, PETAL_VERTICES>(0.0, 0.55, 0.55, 1.0, 1.0)[corner];
        let w = array<f32, PETAL_VERTICES>(0.0, -0.5, 0.5, -0.28, 0.28)[corner];
        let curl = rise * (1.0 - 0.45 * t);
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
    let view = normalize(p - frame.eye_m);
    let light = stem.sunlight;
    let facing = dot(normal, frame.toward_sun);
    let diffuse = clamp((facing + 0.3) / 1.3, 0.0, 1.0);
    let through = 0.35 * max(dot(view, frame.toward_sun), 0.0) * clamp(0.5 - facing, 0.0, 1.0);
    let color = albedo * (frame.sun_rgb * light * (diffuse + through) * 0.85 + ambient(normal) + lamps_on(p, normal, 0.3));
    return color * stem.air.a + stem.air.rgb;
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

@fragment
fn fs(petal: Petal) -> @location(0) vec4<f32> {
    return vec4<f32>(petal.color, 1.0);
}
