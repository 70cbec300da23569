// Clumps of far plants: six rectangles about a vertical axis (000 section 4.1). One instance is 32 clumps.

struct Clump {
    // X and Z of the axis (m), length of a rectangle (m), random number 0..1.
    place: vec4<f32>,
}

// What is the same for all vertices of a clump.
struct Stand {
    // Lean (rad), height of the plants (m), share of the clump that is shown.
    pose: vec4<f32>,
    // Lit colours of the plants' roots and tips; petals' light.
    root_color: vec4<f32>,
    tip_color: vec4<f32>,
    petal_light: vec4<f32>,
}

struct List {
    // Clumps, unused.
    range: vec4<u32>,
}

@group(1) @binding(0) var<storage, read> clumps: array<Clump>;
@group(1) @binding(1) var<uniform> list: List;
@group(1) @binding(2) var tufts: texture_2d<f32>;
@group(1) @binding(3) var<storage, read> stands: array<Stand>;
@group(1) @binding(4) var<storage, read_write> placed: array<Stand>;

// Width and height of the texture's pattern (m per m of mean blade height).
const PATTERN_WIDTH: f32 = 4.0;
const PATTERN_HEIGHT: f32 = 1.25;

@compute @workgroup_size(64)
fn place(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= list.range.x {
        return;
    }
    let clump = clumps[id.x].place;
    let root = clump.xy;
    let share = grass_share(root);
    let height = frame.blade.x * PATTERN_HEIGHT * mix(0.80, 1.18, noise(root / 14.0).a) * sqrt(share);
    let ground = vec3<f32>(root.x, ground_height(root), root.y);
    let distance_m = distance(ground, frame.eye.xyz);
    let lean = lean_at(ground, field_level(distance_m), gust_at(root));
    let fade_in = smoothstep(frame.reach.x * 0.72, frame.reach.y, distance_m + (clump.w - 0.5) * 2.0);
    let fade_out = 1.0 - smoothstep(frame.reach.z, frame.reach.w, distance_m);
    var stand: Stand;
    let light = cloud_light(root) * sun_visible(ground + vec3<f32>(0.0, height * 0.6, 0.0));
    // Clumps rise and sink rather than dissolve.
    // From above, sparse clumps would show as stars; the ground's own colour serves there.
    let down = smoothstep(0.09, 0.22, dot(frame.eye.xyz - ground, ground_normal(root)) / max(distance_m, 1e-3));
    let flat_share = down * smoothstep(frame.reach.y * 0.9, frame.reach.y * 1.6, distance_m);
    let risen = fade_in * mix(0.35, 1.0, fade_out) * (1.0 - flat_share);
    stand.pose = vec4<f32>(lean, height * risen, min(fade_out * 4.0, 1.0) * step(0.1, share) * step(0.05, risen));
    let p = ground + vec3<f32>(0.0, height * risen * 0.5, 0.0);
    let view = normalize(p - frame.eye.xyz);
    let normal = normalize(ground_normal(root) - view * 0.45 + vec3<f32>(lean.x, 0.0, lean.y) * 0.7);
    let tangent = normalize(vec3<f32>(lean.x, 1.0, lean.y));
    let tilt = min(length(lean), 1.45);
    let tint = grass_tint(root);
    let tip = frame.tip_rgb.rgb * tint * (0.90 + 0.42 * smoothstep(0.05, 0.45, tilt));
    // Seen from above a clump shows its upper parts.
    let above = smoothstep(0.10, 0.50, -view.y);
    let base = mix(frame.root_rgb.rgb * tint, tip * 0.8, above * 0.75);
    let root_lit = grass_light(base, normal, tangent, view, light * mix(0.4, 0.9, above), mix(0.3, 0.8, above));
    stand.root_color = vec4<f32>(hazed(root_lit, p), 0.0);
    stand.tip_color = vec4<f32>(hazed(grass_light(tip * trodden(tilt), normal, tangent, view, light, 1.0), p), 0.0);
    stand.petal_light = vec4<f32>(frame.sun_color.rgb * light * 0.6 + ambient(normal), 0.0);
    placed[id.x] = stand;
}

struct Rectangle {
    @builtin(position) position: vec4<f32>,
    @location(0) uv: vec2<f32>,
    // As in `Stand`; share that is shown.
    @location(1) root_color: vec3<f32>,
    @location(2) tip_color: vec3<f32>,
    @location(3) petal_light: vec3<f32>,
    @location(4) shown: f32,
}

@vertex
fn vs(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Rectangle {
    let number = instance * 32u + index / 24u;
    let local = index % 24u;
    var out: Rectangle;
    out.position = vec4<f32>(0.0, 0.0, 0.0, 1.0);
    if number >= list.range.x || stands[number].pose.w <= 0.0 {
        return out;
    }
    let place = clumps[number].place;
    let stand = stands[number];
    let side = local / 4u;
    let outward = f32(local & 1u);
    let upward = f32((local >> 1u) & 1u);
    let angle = (f32(side) / 6.0 + place.w) * TAU;
    let direction = vec2<f32>(cos(angle), sin(angle));
    let root = place.xy + direction * place.z * outward;
    let ground = vec3<f32>(root.x, ground_height(root), root.y);

    // Only the tops move, along a circle about their foot.
    let lean = stand.pose.xy;
    let tilt = min(length(lean), 1.45);
    let aside = lean / max(length(lean), 1e-4) * sin(tilt);
    let top = vec3<f32>(aside.x, cos(tilt), aside.y) * stand.pose.z;
    let p = ground + top * upward + vec3<f32>(0.0, -0.03, 0.0);
    out.root_color = stand.root_color.rgb;
    out.tip_color = stand.tip_color.rgb;
    out.petal_light = stand.petal_light.rgb;
    out.shown = stand.pose.w;
    out.uv = vec2<f32>(
        place.w * 7.0 + f32(side) * 0.37 + outward * place.z / (PATTERN_WIDTH * frame.blade.x),
        1.0 - upward,
    );
    out.position = frame.projection_from_world * vec4<f32>(p, 1.0);
    return out;
}

@fragment
fn fs(r: Rectangle) -> @location(0) vec4<f32> {
    // Texture: height along the plant, hue, petals' share, cover.
    let texel = textureSample(tufts, repeated, vec2<f32>(r.uv.x, clamp(r.uv.y, 0.01, 0.99)));
    let alpha = clamp((texel.a - 0.5) / max(fwidth(texel.a), 0.0001) + 0.5, 0.0, 1.0);
    if alpha * r.shown <= random3(vec2<i32>(r.position.xy), 11u).x * 0.98 + 0.01 {
        discard;
    }
    let up = 1.0 - r.uv.y;
    let t = texel.r * smoothstep(-0.15, 0.75, up);
    let color = plant_color(r.root_color, r.tip_color, t, texel.g);
    let petal = select(vec3<f32>(0.85, 0.80, 0.72), vec3<f32>(0.80, 0.58, 0.06), texel.g > 0.5);
    let flowers = texel.b * step(0.01, frame.root_rgb.w);
    return vec4<f32>(mix(color, petal * r.petal_light, flowers), 1.0);
}
