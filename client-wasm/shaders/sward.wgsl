// What grass shows: a blade at a place on it, and all blades of a place together as they are seen from afar.

// Light that a blade sends to the eye from a share `t` of its length, `height` of its kind's mean height above the ground, where it turns `normal` to the
// eye; `view` runs from the eye to `p`, `light` is the share of the sun's light that reaches the grass there, `hue` runs from fresh to dry.
fn blade_color(
    kind: Kind, tint: vec3<f32>, t: f32, height: f32, hue: f32, tilt: f32, normal: vec3<f32>, tangent: vec3<f32>, view: vec3<f32>, p: vec3<f32>, light: f32,
) -> vec3<f32> {
    var albedo = tint * plant_color(kind.root.rgb, kind.tip.rgb, t, hue);
    let straw = smoothstep(0.86, 0.99, hue) * 0.75;
    albedo = mix(albedo, vec3<f32>(0.38, 0.30, 0.13) * (0.35 + 0.65 * t), straw);
    // Pale ends, as of flowering grass.
    albedo = mix(albedo, albedo * vec3<f32>(1.35, 1.12, 0.95), smoothstep(0.72, 1.0, t) * smoothstep(0.3, 0.9, hue));
    albedo *= (0.90 + 0.42 * smoothstep(0.15, 0.6, sin(tilt)) * t) * trodden(tilt);
    // Little light is lost on the way down into short grass.
    let deep = smoothstep(0.0, 0.60, kind.root.w);
    let occlusion = mix(mix(0.60, 0.16, deep), 1.0, smoothstep(0.0, 0.85, max(height, t * 0.75)));
    let lit = light * sun_in_grass(max(height, t * 0.7), kind.root.w);
    return grass_light(albedo, normal, tangent, view, lit, occlusion) + grass_lamps(albedo, normal, tangent, view, p, height);
}

// Leaf area that a ray meets on its way through the whole sward, over the ground below it: half of the leaves' area, since they stand every way.
const FACING: f32 = 0.5;
// The same of what is seen, since blades stand in tufts and hide each other there.
const SEEN: f32 = 0.3;
// How much lower than the tallest blades those are on which a level look ends, over their height.
const RAGGED: f32 = 0.1;

// Leaf area over the ground of blades drawn at a distance, which are fewer there, and wider.
fn drawn_leaf_area(distance_m: f32, kind: Kind) -> f32 {
    let shown = 1.0 - smoothstep(frame.reach.x, frame.reach.y, distance_m);
    return frame.sward.x * sqrt(density(distance_m, frame.sward.y)) * shown * leafiness(kind);
}

// Distance from which on the grass about a plant is seen as from afar (m).
const NEAR_M: f32 = 2.0;

// How much of what would be seen from afar along `view` is seen between the blades that are drawn: what is between them is dark where they hide the ground, and
// the more so the more of all blades they are.
fn bare_between(distance_m: f32, kind: Kind, view: vec3<f32>, up: vec3<f32>) -> f32 {
    let drawn = drawn_leaf_area(distance_m, kind);
    let hidden = 1.0 - exp(-FACING * drawn / clamp(-dot(view, up), 0.3, 1.0));
    let bare = 1.0 - hidden * hidden * min(drawn / (frame.sward.x * leafiness(kind)), 1.0);
    // An eye among the blades looks between them.
    return bare * smoothstep(0.1, NEAR_M, distance_m);
}

// How much a single blade stands out: of several to a pixel what is seen is their mean, which varies as the root of their number.
fn contrast(distance_m: f32) -> f32 {
    return clamp(sqrt(1.5 * frame.sward.z / (distance_m * frame.screen.z)), 0.0, 1.0);
}

// What is seen of a plant's part of a colour so far up in the grass (0 at the ground, 1 at its top), where `about` is what the grass about it looks like from
// afar, and how much of that shows between the plants that are drawn: down in the grass it is one with what is not drawn.
fn among(color: vec3<f32>, about: vec4<f32>, up: f32, distance_m: f32) -> vec3<f32> {
    let own = contrast(distance_m) * (1.0 - about.w * (1.0 - smoothstep(0.0, 0.8, up)));
    return mix(about.rgb, color, own);
}

// Leaf area of a kind over that of the first kind, which the frame's is of.
fn leafiness(kind: Kind) -> f32 {
    return kind.shape.w * kind.root.w / (kinds.list[0].shape.w * kinds.list[0].root.w);
}

// All blades of a place as they are seen from afar: the deeper a leaf is, the less of it; leaves' depths are those of equal shares of what is seen.
fn sward_color(p: vec3<f32>, up: vec3<f32>, kind: Kind, tint: vec3<f32>, lean: vec2<f32>, view: vec3<f32>, light: f32) -> vec3<f32> {
    let leaf_area = frame.sward.x * leafiness(kind);
    let free = clamp(-dot(view, up), 0.05, 1.0) / (SEEN * max(leaf_area, 0.05));
    let tilt = length(lean);
    let tangent = normalize(up + vec3<f32>(lean.x, 0.0, lean.y) * 1.4);
    // Blades stand every way, and those that turn to the eye are seen.
    let facing = normalize(up * 0.75 - (view - up * dot(view, up)) * 0.45 + vec3<f32>(lean.x, 0.0, lean.y) * 0.3);
    var color = vec3<f32>(0.0);
    for (var i = 0; i < 2; i++) {
        let height = max(1.0 - RAGGED - free * select(1.39, 0.29, i == 0), 0.0);
        let t = mix(height, 1.0, 0.35);
        color += blade_color(kind, tint, t, height, select(0.65, 0.35, i == 0), tilt, facing, tangent, view, p, light);
    }
    return 0.5 * color;
}
