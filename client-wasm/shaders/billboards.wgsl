// Clumps of far plants: six rectangles about a vertical axis (000 section 4.1). One instance is 32 clumps.

struct Clump {
    // X and Z of the axis (m), length of a rectangle (m), random number 0..1.
    place: vec4<f32>,
}

struct List {
    // Clumps, unused.
    range: vec4<u32>,
}

@group(1) @binding(0) var<storage, read> clumps: array<Clump>;
@group(1) @binding(1) var<uniform> list: List;
@group(1) @binding(2) var tufts: texture_2d<f32>;

// Width and height of the texture's pattern (m per m of mean blade height).
const PATTERN_WIDTH: f32 = 4.0;
const PATTERN_HEIGHT: f32 = 1.25;

struct Rectangle {
    @builtin(position) position: vec4<f32>,
    @location(0) uv: vec2<f32>,
    @location(1) p: vec3<f32>,
    @location(2) root: vec2<f32>,
    @location(3) shown: f32,
    @location(4) lean: vec2<f32>,
    @location(5) light: f32,
}

@vertex
fn vs(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Rectangle {
    let number = instance * 32u + index / 24u;
    let local = index % 24u;
    var out: Rectangle;
    if number >= list.range.x {
        out.position = vec4<f32>(0.0, 0.0, 0.0, 1.0);
        return out;
    }
    let place = clumps[number].place;
    let side = local / 4u;
    let outward = f32(local & 1u);
    let upward = f32((local >> 1u) & 1u);
    let angle = (f32(side) / 6.0 + place.w) * TAU;
    let direction = vec2<f32>(cos(angle), sin(angle));
    let root = place.xy + direction * place.z * outward;
    let share = grass_share(root);
    let height = frame.blade.x * PATTERN_HEIGHT * mix(0.80, 1.18, noise(root / 14.0).a) * sqrt(share);
    let ground = vec3<f32>(root.x, ground_height(root), root.y);

    // Only the tops move, along a circle about their foot.
    let distance_m = distance(ground, frame.eye.xyz);
    let wind = wind_at(ground, 1.0).xz * gust_at(root);
    let lean = lean_of_wind(wind) + lean_of_field(root, field_level(distance_m));
    let tilt = min(length(lean), 1.45);
    let aside = lean / max(length(lean), 1e-4) * sin(tilt);
    let top = vec3<f32>(aside.x, cos(tilt), aside.y) * height;
    let p = ground + top * upward + vec3<f32>(0.0, -0.03, 0.0);

    let fade_in = smoothstep(frame.reach.x * 0.72, frame.reach.y, distance_m + (place.w - 0.5) * 2.0);
    let fade_out = 1.0 - smoothstep(frame.reach.z, frame.reach.w, distance_m);
    out.shown = fade_in * fade_out * step(0.02, share);
    out.uv = vec2<f32>(
        place.w * 7.0 + f32(side) * 0.37 + outward * place.z / (PATTERN_WIDTH * frame.blade.x),
        1.0 - upward,
    );
    out.p = p;
    out.root = root;
    out.lean = lean;
    out.light = cloud_light(root) * sun_visible(ground + vec3<f32>(0.0, height * 0.6, 0.0));
    out.position = frame.projection_from_world * vec4<f32>(p, 1.0);
    if out.shown <= 0.0 {
        out.position = vec4<f32>(0.0, 0.0, 0.0, 1.0);
    }
    return out;
}

@fragment
fn fs(r: Rectangle) -> @location(0) vec4<f32> {
    // Texture: height along the plant, hue, petals' share, cover.
    let texel = textureSample(tufts, repeated, vec2<f32>(r.uv.x, clamp(r.uv.y, 0.01, 0.99)));
    let place = random3(vec2<i32>(r.position.xy), 11u).x;
    let alpha = clamp((texel.a - 0.5) / max(fwidth(texel.a), 0.0001) + 0.5, 0.0, 1.0);
    if alpha * r.shown <= place * 0.98 + 0.01 {
        discard;
    }
    let view = normalize(r.p - frame.eye.xyz);
    let t = texel.r;
    let hue = texel.g;
    let up = ground_normal(r.root);
    let normal = normalize(up - view * 0.45 + vec3<f32>(r.lean.x, 0.0, r.lean.y) * 0.7);
    let tangent = normalize(vec3<f32>(r.lean.x, 1.0, r.lean.y));
    var albedo = mix(frame.root_rgb.rgb, frame.tip_rgb.rgb, t * 0.85 + t * t * 0.15);
    albedo *= grass_tint(r.root) * mix(vec3<f32>(0.82, 0.98, 0.80), vec3<f32>(1.16, 1.04, 0.86), hue);
    albedo *= 0.90 + 0.42 * smoothstep(0.05, 0.45, length(r.lean)) * t;
    let flowers = texel.b * step(0.01, frame.root_rgb.w);
    let petal = select(vec3<f32>(0.85, 0.80, 0.70), vec3<f32>(0.80, 0.62, 0.05), hue > 0.5);
    albedo = mix(albedo, petal, flowers);
    let occlusion = mix(0.22, 1.0, smoothstep(0.0, 0.75, 1.0 - r.uv.y));
    let light = r.light * mix(0.35, 1.0, smoothstep(0.05, 0.7, 1.0 - r.uv.y));
    return vec4<f32>(hazed(grass_light(albedo, normal, tangent, view, light, occlusion), r.p), 1.0);
}
