// Clumps of far plants: six rectangles about a vertical axis (000 section 4.1). One instance is 32 clumps.

struct Clump {
    // X and Z of the axis (m), length of a rectangle (m), random number 0..1.
    place: vec4<f32>,
}

// What is the same for all vertices of a clump.
struct Stand {
    // Height of its pattern (m), segments, share of the clump that is shown, unused.
    pose: vec4<f32>,
    // Tops of the segments, from the foot (m).
    joints: array<vec4<f32>, 6>,
    // Lit colours of the plants' roots and tips; petals' light.
    root_color: vec4<f32>,
    tip_color: vec4<f32>,
    petal_light: vec4<f32>,
}

struct List {
    // Clumps; instances whose clumps have several segments, and how many their rectangles have at most; those clumps.
    range: vec4<u32>,
    // Distance from which on clumps begin to bend as a whole (m), and at which all do; unused.
    several: vec4<f32>,
}

@group(1) @binding(0) var<storage, read> clumps: array<Clump>;
@group(1) @binding(1) var<uniform> list: List;
@group(1) @binding(2) var tufts: texture_2d<f32>;
@group(1) @binding(3) var<storage, read> stands: array<Stand>;
@group(1) @binding(4) var<storage, read_write> placed: array<Stand>;
// Keys and numbers of clumps far to near, those of one segment before all others: what is sorted, and what is drawn.
@group(1) @binding(5) var<storage, read_write> keyed: array<vec2<u32>>;
@group(1) @binding(6) var<storage, read> in_order: array<vec2<u32>>;

// Clumps in one instance; twin of the constant in `billboards.rs`.
const CLUMPS: u32 = 32u;
// Width and height of the texture's pattern (m per m of mean blade height).
const PATTERN_WIDTH: f32 = 4.0;
const PATTERN_HEIGHT: f32 = 1.25;

// Tops of the segments of a clump on `ground` (m from there) whose kind bends the lowest by `lean`, those above as it did a while ago
// (001 section 4.5); the farther it is, the more they are one straight line. None is below the land.
fn joints_of(ground: vec3<f32>, kind: Kind, segments: u32, height: f32, level: f32, wind_lean: vec2<f32>, straight: f32) -> array<vec4<f32>, 6> {
    let p = ground.xz;
    let share = field_share(p);
    let now = bend_at(p, level, 0);
    let lowest = wind_lean + lean_of_bend(now) * share;
    let curl = (1.0 - straight) * (1.0 - smoothstep(0.5, 1.3, length(lowest)));
    var joints: array<vec4<f32>, 6>;
    var at = vec3<f32>(0.0);
    for (var i = 0u; i < segments; i++) {
        var lean = lowest;
        if i > 0u && share > 0.0 && straight < 1.0 {
            let secs = kind.lag.z * f32(i) / f32(segments - 1u);
            lean = mix(wind_lean + trailing_lean(p, level, now, kind, secs) * share, lowest, straight);
        }
        if segments > 1u {
            lean *= 1.0 + curl * (0.7 * f32(i) / f32(segments - 1u) - 0.35);
        }
        let tilt = min(length(lean), 1.45);
        let aside = lean / max(length(lean), 1e-4) * sin(tilt);
        at += vec3<f32>(aside.x, cos(tilt), aside.y) * (height / f32(segments));
        at.y = max(at.y, ground_height(p + at.xz) - ground.y);
        joints[i] = vec4<f32>(at, 0.0);
    }
    return joints;
}

@compute @workgroup_size(64)
fn place(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= list.range.x {
        return;
    }
    let clump = clumps[id.x].place;
    let root = clump.xy;
    let share = grass_share(root);
    // Kinds mingle where they meet.
    let kind = kinds.list[kind_at(root + (vec2<f32>(clump.w, fract(clump.w * 7.3)) - 0.5) * 0.9)];
    let height = kind.root.w * PATTERN_HEIGHT * fed(root) * sqrt(share);
    let ground = vec3<f32>(root.x, ground_height(root), root.y);
    let distance_m = distance(ground, frame.eye.xyz);
    let level = field_level(distance_m);
    let wind_lean = lean_of_wind(wind_at(ground, 0.0).xz * gust_at(root), kind.tip.w);
    let lean = lean_of_field(root, level) + wind_lean;
    // As single plants fade out (000 section 6.1).
    let fade_in = smoothstep(frame.reach.x, frame.reach.y, distance_m + (clump.w - 0.5) * 2.0);
    let fade_out = 1.0 - smoothstep(frame.reach.z, frame.reach.w, distance_m);
    var stand: Stand;
    let light = cloud_light(root) * sun_visible(ground + vec3<f32>(0.0, height * 0.6, 0.0));
    // From above, sparse clumps would show as stars; the ground's own colour serves there.
    let down = smoothstep(0.09, 0.22, dot(frame.eye.xyz - ground, ground_normal(root)) / max(distance_m, 1e-3));
    let flat_share = down * smoothstep(frame.reach.y * 0.9, frame.reach.y * 1.6, distance_m);
    let risen = mix(0.35, 1.0, fade_out) * (1.0 - flat_share);
    let segments = select(1u, u32(kind.shape.x), id.x / CLUMPS < list.range.y);
    let straight = smoothstep(list.several.x, list.several.y, distance_m);
    stand.pose = vec4<f32>(kind.root.w, f32(segments), fade_in * min(fade_out * 4.0, 1.0) * step(0.1, share) * step(0.05, risen), 0.0);
    if stand.pose.z > 0.0 {
        stand.joints = joints_of(ground, kind, segments, height * risen, level, wind_lean, straight);
    }
    let p = ground + vec3<f32>(0.0, height * risen * 0.5, 0.0);
    let view = normalize(p - frame.eye.xyz);
    let normal = normalize(ground_normal(root) - view * 0.45 + vec3<f32>(lean.x, 0.0, lean.y) * 0.7);
    let tangent = normalize(vec3<f32>(lean.x, 1.0, lean.y));
    let tilt = min(length(lean), 1.45);
    let tint = grass_tint(root);
    // Far down a clump is one with the grass about it that is not drawn.
    let afar = sward_color(ground, ground_normal(root), kind, tint, lean, view, light);
    stand.root_color = vec4<f32>(hazed(afar, p), 0.0);
    let top = blade_color(kind, tint, 0.95, 0.9, 0.5, tilt, normal, tangent, view, p, light);
    stand.tip_color = vec4<f32>(hazed(mix(afar, top, 0.35 + 0.65 * contrast(distance_m)), p), 0.0);
    stand.petal_light = vec4<f32>(frame.sun_color.rgb * light * 0.6 + ambient(normal) + lamps_on(p, normal, 0.3), 0.0);
    placed[id.x] = stand;
}

@compute @workgroup_size(64)
fn key_clumps(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < list.range.x {
        let root = clumps[id.x].place.xy;
        let near = nearness(distance(vec3<f32>(root.x, ground_height(root), root.y), frame.eye.xyz));
        keyed[id.x] = vec2<u32>((u32(id.x < list.range.w) << 15u) | near, id.x);
    }
}

struct Rectangle {
    @builtin(position) position: vec4<f32>,
    @location(0) uv: vec2<f32>,
    // As in `Stand`; share that is shown.
    @location(1) root_color: vec3<f32>,
    @location(2) tip_color: vec3<f32>,
    @location(3) petal_light: vec3<f32>,
    @location(4) shown: f32,
    // From the eye (m).
    @location(5) distance_m: f32,
}

// A corner of one of a clump's six rectangles: two a row, from the lowest.
fn corner_of(number: u32, side: u32, corner: u32) -> Rectangle {
    var out: Rectangle;
    out.position = vec4<f32>(0.0, 0.0, 0.0, 1.0);
    if stands[number].pose.z <= 0.0 {
        return out;
    }
    let place = clumps[number].place;
    let pose = stands[number].pose;
    let outward = f32(corner & 1u);
    // Rows above the topmost segment of its kind lie on its top.
    let row = min(corner >> 1u, u32(pose.y));
    let angle = (f32(side) / 6.0 + place.w) * TAU;
    let direction = vec2<f32>(cos(angle), sin(angle));
    let root = place.xy + direction * place.z * outward;
    var p = vec3<f32>(root.x, ground_height(root) - 0.03, root.y);
    if row > 0u {
        p += stands[number].joints[row - 1u].xyz;
    }
    let upward = f32(row) / pose.y;
    out.root_color = stands[number].root_color.rgb;
    out.tip_color = stands[number].tip_color.rgb;
    out.petal_light = stands[number].petal_light.rgb;
    out.shown = pose.z;
    out.uv = vec2<f32>(
        place.w * 7.0 + f32(side) * 0.37 + outward * place.z / (PATTERN_WIDTH * pose.x),
        1.0 - upward,
    );
    out.position = frame.projection_from_world * vec4<f32>(p, 1.0);
    out.distance_m = distance(p, frame.eye.xyz);
    return out;
}

fn hidden() -> Rectangle {
    var out: Rectangle;
    out.position = vec4<f32>(0.0, 0.0, 0.0, 1.0);
    return out;
}

@vertex
fn vs(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Rectangle {
    let rows = select(1u, list.range.z, instance < list.range.y);
    let corners = 2u * (rows + 1u);
    let number = instance * CLUMPS + index / (6u * corners);
    if number >= list.range.x {
        return hidden();
    }
    return corner_of(number, index / corners % 6u, index % corners);
}

// Instances of clumps of one segment come first.
@vertex
fn vs_in_order(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Rectangle {
    let single = list.range.x - list.range.w;
    let single_instances = (single + CLUMPS - 1u) / CLUMPS;
    let is_single = instance < single_instances;
    let rows = select(list.range.z, 1u, is_single);
    let corners = 2u * (rows + 1u);
    let first = select(single + (instance - single_instances) * CLUMPS, instance * CLUMPS, is_single);
    let at = first + index / (6u * corners);
    if at >= select(list.range.x, single, is_single) {
        return hidden();
    }
    let number = in_order[at].y;
    // The rectangle that points away from the eye, those on both sides of it, and so on.
    let place = clumps[number].place;
    let away = place.xy - frame.eye.xz;
    let farthest = round((atan2(away.y, away.x) / TAU - place.w) * 6.0);
    let aside = array<f32, 6>(0.0, 1.0, -1.0, 2.0, -2.0, 3.0)[index / corners % 6u];
    return corner_of(number, u32(farthest + aside + 18.0) % 6u, index % corners);
}

// Opacity below which nothing is drawn.
const LEAST: f32 = 0.08;

fn painted(r: Rectangle) -> vec4<f32> {
    // Texture: height along the plant, hue, petals' share, cover.
    let texel = textureSample(tufts, repeated, vec2<f32>(r.uv.x, clamp(r.uv.y, 0.01, 0.99)));
    let alpha = clamp((texel.a - 0.5) / max(fwidth(texel.a), 0.0001) + 0.5, 0.0, 1.0);
    let up = 1.0 - r.uv.y;
    let t = texel.r * smoothstep(-0.15, 0.75, up);
    let color = mix(r.root_color, r.tip_color, t * t);
    let petal = select(vec3<f32>(0.85, 0.80, 0.72), vec3<f32>(0.80, 0.58, 0.06), texel.g > 0.5);
    let flowers = texel.b * step(0.01, frame.blade.x);
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
    if paint.a < LEAST {
        discard;
    }
    return paint;
}

@fragment
fn fs_weighted(r: Rectangle) -> Weighted {
    let paint = painted(r);
    return weighted(paint.rgb, paint.a, r.distance_m, 1.0 - r.uv.y);
}
