// Light of sun, sky and lamps, what the air between adds, and how grass is lit. Colours are of the picture: illuminance over π, or luminance, times the
// exposure. The formulas of grass and lamps have twins in shared/src/light.

struct Lamp {
    // Where it is (m); distance at which it ends (m).
    place: vec4<f32>,
    // Light at 1 m; cosine at which its cone ends.
    rgb: vec4<f32>,
    // Unit vector along its cone; cosine up to which that is full.
    aim: vec4<f32>,
    // Constant, linear and quadratic term; unused.
    attenuation: vec4<f32>,
}

struct Lights {
    far_shadow_from_world: mat4x4<f32>,
    mean: vec4<f32>,
    up: vec4<f32>,
    toward_sun: vec4<f32>,
    night: vec4<f32>,
    cloud_sun: vec4<f32>,
    heading: vec4<f32>,
    lit: vec4<f32>,
    mist: vec4<f32>,
    shadow: vec4<f32>,
    lamps: array<Lamp, 16>,
}

@group(0) @binding(13) var sky_table: texture_2d<f32>;

// --- sky and air ------------------------------------------------------------------------------------------------------

// Twin of `haze_phase` in shared/src/light/air.rs.
const HAZE_FORWARD: f32 = 0.76;

fn haze_phase(cosine: f32) -> f32 {
    let under = 1.0 + HAZE_FORWARD * HAZE_FORWARD - 2.0 * HAZE_FORWARD * cosine;
    return (1.0 - HAZE_FORWARD * HAZE_FORWARD) / (2.0 * TAU * under * sqrt(under));
}

// Unit vector on the ground towards the sun.
fn sun_heading() -> vec2<f32> {
    return frame.lights.heading.xy;
}

// Sky over a direction: twin of `Sky::luminance` in shared/src/light/sky.rs. The upper half of the table has what molecules scatter, the lower that of
// haze over its phase.
fn sky_color(direction: vec3<f32>) -> vec3<f32> {
    let up = clamp(direction.y, 0.0, 1.0);
    let level = direction.xz / max(length(direction.xz), 1e-4);
    let size = vec2<f32>(textureDimensions(sky_table)) * vec2<f32>(1.0, 0.5);
    let place = vec2<f32>(sqrt(clamp(0.5 - 0.5 * dot(level, sun_heading()), 0.0, 1.0)), sqrt(up));
    let uv = (place * (size - 1.0) + 0.5) / (size * vec2<f32>(1.0, 2.0));
    let molecules = textureSampleLevel(sky_table, clamped, uv, 0.0).rgb;
    let haze = textureSampleLevel(sky_table, clamped, uv + vec2<f32>(0.0, 0.5), 0.0).rgb;
    let clear = molecules + haze * haze_phase(dot(direction, frame.sun.xyz)) + frame.lights.night.rgb;
    // Under rain clouds all directions are grey, the horizon a little brighter.
    let grey = dot(frame.lights.mean.rgb + frame.lights.up.rgb, vec3<f32>(0.2126, 0.7152, 0.0722));
    let overcast = vec3<f32>(0.94, 0.99, 1.06) * (grey * mix(1.0, 0.68, sqrt(up)));
    return mix(clear, overcast, frame.screen.w);
}

// Light from sky and land on a surface, over π; twin of `Sky::ambient`.
fn ambient(normal: vec3<f32>) -> vec3<f32> {
    return frame.lights.mean.rgb + frame.lights.up.rgb * normal.y + frame.lights.toward_sun.rgb * dot(normal.xz, sun_heading());
}

// Optical depth of air that thins out with height, along a way that begins `low` and rises by `rise` scale heights, over that of as much air of its density
// at the height 0.
fn thinned_depth(low: f32, rise: f32) -> f32 {
    let even = exp(-clamp(low, -4.0, 60.0));
    if abs(rise) < 0.01 {
        return even * (1.0 - 0.5 * rise);
    }
    return even * (1.0 - exp(-clamp(rise, -20.0, 60.0))) / rise;
}

// What the air before a place adds to its colour, and the share of that which it lets through: haze that shows the sky behind it, warm and bright about the sun,
// and mist on low land, lit by all there is.
fn air_before(p: vec3<f32>) -> vec4<f32> {
    let to = p - frame.eye.xyz;
    let distance_m = length(to);
    let direction = to / max(distance_m, 1e-3);
    let above_m = frame.eye.y - frame.lights.mist.z;
    let depth = distance_m / frame.sun_color.w * thinned_depth(above_m / HAZE_HEIGHT_M, to.y / HAZE_HEIGHT_M);
    let behind = sky_color(normalize(vec3<f32>(direction.x, max(direction.y, 0.0) + 0.03, direction.z)));
    // When the sun has set, its glow is high up: the air between is lit by the whole sky.
    let around = frame.lights.mean.rgb + frame.lights.up.rgb * 0.6;
    let air = mix(around, behind, 0.3 + 0.7 * smoothstep(-0.04, 0.10, frame.sun.y));
    let through = exp(-depth);
    let mist = exp(-distance_m * frame.lights.mist.x * thinned_depth(above_m / frame.lights.mist.y, to.y / frame.lights.mist.y));
    let ahead = max(dot(direction, frame.sun.xyz), 0.0);
    let ahead2 = ahead * ahead;
    let lit = (frame.lights.mean.rgb + frame.lights.up.rgb * 0.5) * 0.95 + frame.sun_color.rgb * (0.10 + 0.45 * ahead2 * ahead2 * ahead2);
    return vec4<f32>(mix(lit, air * (0.93 * (1.0 - through)), mist), through * mist);
}

// A colour seen through the air.
fn hazed(color: vec3<f32>, p: vec3<f32>) -> vec3<f32> {
    let air = air_before(p);
    return color * air.a + air.rgb;
}

// Height over which haze is 1/e as dense (m).
const HAZE_HEIGHT_M: f32 = 700.0;

// --- sun --------------------------------------------------------------------------------------------------------------

// Light that clouds let through, as soft shadows that drift over the land.
fn cloud_light(p: vec2<f32>) -> f32 {
    let at = (p + frame.clouds.xy * 0.5) / 620.0;
    let n = noise(at).r * 0.65 + noise(at * 2.7).a * 0.35;
    return 1.0 - 0.62 * smoothstep(0.47, 0.66, n);
}

// Angle of the sun's disc (rad), with the bright haze about it.
const SUN_RAD: f32 = 0.014;
// Largest half-width of a half-shadow (texels of the map).
const SOFTEST_PX: f32 = 4.0;

// Light past what throws shadows into a layer of the map, at a place there. The half-shadow is as wide as the sun is seen wide from what throws it
// (R. Fernando, "Percentage-closer soft shadows", 2005): four texels about the place say how far that is, four comparisons how much of the sun it hides; none where nothing is
// before any of the texels.
fn soft_shadow(place: vec3<f32>, layer: i32, depth_m: f32, texel_m: f32, turn: vec2<f32>) -> f32 {
    let size = vec2<f32>(textureDimensions(shadows));
    let depth = place.z - 0.6 * (0.2 + texel_m) / depth_m;
    var nearest_m = 0.0;
    var found = 0.0;
    for (var i = 0; i < 4; i++) {
        let offset = spread(i, turn) * SOFTEST_PX * 0.75;
        let at = vec2<i32>(clamp(place.xy * size + offset, vec2<f32>(0.0), size - 1.0));
        let away_m = (depth - textureLoad(shadows, at, layer, 0)) * depth_m;
        if away_m > 0.0 {
            nearest_m += away_m;
            found += 1.0;
        }
    }
    if found == 0.0 {
        return 1.0;
    }
    let half_px = clamp(nearest_m / found * SUN_RAD * 0.5 / texel_m, 0.8, SOFTEST_PX);
    var light = 0.0;
    for (var i = 0; i < 4; i++) {
        light += textureSampleCompareLevel(shadows, shadow_sampler, place.xy + spread(i, turn) * half_px / size, layer, depth);
    }
    return light * 0.25;
}

// Four places spread over a disc, turned.
fn spread(i: i32, turn: vec2<f32>) -> vec2<f32> {
    let at = array<vec2<f32>, 4>(vec2<f32>(0.35, 0.1), vec2<f32>(-0.15, 0.65), vec2<f32>(-0.8, -0.25), vec2<f32>(0.3, -0.85))[i];
    return vec2<f32>(at.x * turn.x - at.y * turn.y, at.x * turn.y + at.y * turn.x);
}

// Share of the sun that objects and trees leave at a place: by the sharp layer of the map near by, by the coarse one farther off.
fn sun_visible(p: vec3<f32>) -> f32 {
    let angle = random3(vec2<i32>(floor(p.xz * 97.0)), bitcast<u32>(i32(floor(p.y * 97.0)))).x * TAU;
    let turn = vec2<f32>(cos(angle), sin(angle));
    let near = (frame.shadow_from_world * vec4<f32>(p, 1.0)).xyz;
    let far = (frame.lights.far_shadow_from_world * vec4<f32>(p, 1.0)).xyz;
    let off = border_of(near);
    let far_off = border_of(far);
    // Most places are in one layer alone.
    let first = select(0, 1, off >= 0.98);
    let last = select(1, 2, off >= 0.88 && far_off < 0.98);
    var light = 1.0;
    for (var layer = first; layer < last; layer++) {
        let is_far = layer == 1;
        let place = select(near, far, is_far);
        let sizes_m = select(frame.lights.shadow.xy, frame.lights.shadow.zw, is_far);
        let seen = soft_shadow(vec3<f32>(place.xy * vec2<f32>(0.5, -0.5) + 0.5, place.z), layer, sizes_m.y, sizes_m.x, turn);
        let share = select(1.0, smoothstep(0.88, 0.98, off) * (1.0 - smoothstep(0.85, 0.98, far_off)), is_far);
        light = mix(light, seen, share);
    }
    return light;
}

// How near a place on the shadow map is to its border: 1 there.
fn border_of(place: vec3<f32>) -> f32 {
    return max(max(abs(place.x), abs(place.y)), abs(place.z * 2.0 - 1.0));
}

// --- lamps ------------------------------------------------------------------------------------------------------------

struct LampRay {
    // Unit vector towards the lamp.
    toward: vec3<f32>,
    rgb: vec3<f32>,
}

// Twin of `attenuation` in shared/src/light/lamp.rs.
fn attenuation(weights: vec3<f32>, distance_m: f32) -> f32 {
    let d = max(distance_m, 0.1);
    return 1.0 / dot(weights, vec3<f32>(1.0, d, d * d));
}

// Light of a lamp at a place: none where it ends.
fn lamp_ray(lamp: Lamp, p: vec3<f32>) -> LampRay {
    let to = lamp.place.xyz - p;
    let distance_m = length(to);
    let toward = to / max(distance_m, 1e-3);
    let cone = smoothstep(lamp.rgb.w, lamp.aim.w, -dot(toward, lamp.aim.xyz));
    let ending = 1.0 - smoothstep(0.7, 1.0, distance_m / lamp.place.w);
    return LampRay(toward, lamp.rgb.rgb * (attenuation(lamp.attenuation.xyz, distance_m) * cone * ending));
}

// Whether any lamp is lit. Known as a pipeline is made, since software drivers run the first turn of a loop even where there is none.
override has_lamps: bool = true;

// Lamps that may reach a place. The count depends on the place, so that drivers which make a shader anew for each value of a uniform that decides its way
// through the program do not.
fn lamps_about(p: vec3<f32>) -> u32 {
    return select(0u, frame.tiling.w, has_lamps && distance(p, frame.lights.lit.xyz) < frame.lights.lit.w);
}

// Light of all lamps on a surface, over π; `around` is how far light wraps around it: 0 of a solid.
fn lamps_on(p: vec3<f32>, normal: vec3<f32>, around: f32) -> vec3<f32> {
    var light = vec3<f32>(0.0);
    for (var i = 0u; i < lamps_about(p); i++) {
        let ray = lamp_ray(frame.lights.lamps[i], p);
        light += ray.rgb * clamp((dot(normal, ray.toward) + around) / (1.0 + around), 0.0, 1.0);
    }
    return light;
}

// --- grass ------------------------------------------------------------------------------------------------------------

// Banks's and Kajiya and Kay's cosine between a light, or half-way vector, and a blade's nearest normal; twin of `diffuse` in shared/src/light/grass.rs.
fn nearest_normal(along: f32) -> f32 {
    return sqrt(max(1.0 - along * along, 0.0));
}

// Twin of `self_shadow` there.
fn self_shadow(height_share: f32, least: f32) -> f32 {
    return clamp(height_share, 0.0, 1.0) * (1.0 - least) + least;
}

// Twin of `sun_through_leaves` there.
fn sun_through_leaves(leaf_area_index: f32, depth_share: f32, sine_of_elevation: f32) -> f32 {
    return exp(-0.5 * leaf_area_index * max(depth_share, 0.0) / max(sine_of_elevation, 0.12));
}

// Area of leaves over that of ground in grass 0.6 m tall and more, as far as the clumps that they stand in let them shade each other; and what leaves pass on
// among themselves.
const LEAF_AREA_INDEX: f32 = 1.25;
const PASSED_ON: f32 = 0.10;

// Share of the sun that grass of a height leaves at a share of that: its shadow on itself.
fn sun_in_grass(height_share: f32, grass_m: f32) -> f32 {
    let index = LEAF_AREA_INDEX * smoothstep(0.0, 0.6, grass_m);
    return mix(sun_through_leaves(index, 1.0 - height_share, frame.sun.y), 1.0, PASSED_ON);
}

// What a blade sends to the eye of the light from a direction: reflected as from a strip that is partly round (its own normal, and Kajiya and Kay's), let
// through mostly straight on, and a highlight along it. `view` runs from the eye to the point. Averaged over all directions to the eye, both together are
// at most 1.1 times the albedo.
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

// Light of sun and sky on something thin and green. `sun_light` is the share of the sun that comes to it; `occlusion` 0..1 darkens what stands deep in
// the grass.
fn grass_light(
    albedo: vec3<f32>, normal: vec3<f32>, tangent: vec3<f32>, view: vec3<f32>, sun_light: f32, occlusion: f32,
) -> vec3<f32> {
    let direct = frame.sun_color.rgb * sun_light * leaf_light(albedo, normal, tangent, view, frame.sun.xyz);
    let around = ambient(normal);
    // A little of the sky is mirrored by the waxy skin.
    return direct * mix(0.25, 1.0, occlusion) + (albedo + 0.04 + 0.03 * sun_light) * around * occlusion;
}

// Light of all lamps on the same, at a share of the grass's height.
fn grass_lamps(albedo: vec3<f32>, normal: vec3<f32>, tangent: vec3<f32>, view: vec3<f32>, p: vec3<f32>, height_share: f32) -> vec3<f32> {
    var light = vec3<f32>(0.0);
    for (var i = 0u; i < lamps_about(p); i++) {
        if distance(p, frame.lights.lamps[i].place.xyz) < frame.lights.lamps[i].place.w {
            let ray = lamp_ray(frame.lights.lamps[i], p);
            light += ray.rgb * leaf_light(albedo, normal, tangent, view, ray.toward);
        }
    }
    return light * self_shadow(height_share, 0.3);
}

