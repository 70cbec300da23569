// Dust carried by the streamed wind: motes near the camera, and soft puffs of haze farther away. Both drift in squares that move with it:
// sprites that leave a square on one side enter again on the other, faded out at the rim.

import package::constants::WORKGROUP_SIZE;
import package::inputs::frame::frame;
import package::inputs::lamps::lamps_on;
import package::inputs::noise::noise;
import package::inputs::shadows::sun_visible;
import package::inputs::wind::{air_at, dust_of, wind_at};
import package::land_and_sky::clouds::cloud_light;
import package::land_and_sky::ground::ground_height;
import package::land_and_sky::haze::hazed;
import package::land_and_sky::sky_light::ambient;
import package::uniforms::Drift;

// Place of a mote or a puff.
struct DustPlace {
    // X, height above the ground, Z (m).
    at_m: vec3<f32>,
    // Random number 0..1.
    random: f32,
}

// A mote or a puff to be drawn.
struct Sprite {
    // Centre (m).
    centre_m: vec3<f32>,
    opacity: f32,
    // Half-length, as a vector (m).
    half_length_m: vec3<f32>,
    half_width_m: f32,
    // Lit colour.
    color: vec3<f32>,
    // Random number 0..1.
    random: f32,
}

@group(1) @binding(0) var<uniform> drift: Drift;
// Puffs, then motes.
@group(1) @binding(1) var<storage, read_write> places: array<DustPlace>;
@group(1) @binding(2) var<storage, read_write> drawn: array<Sprite>;
@group(1) @binding(3) var<storage, read> sprites: array<Sprite>;

// Half-width of a mote (m).
const MOTE_M: f32 = 0.010;
// Half-width of a puff (m).
const PUFF_M: f32 = 4.2;
// Exposure time of the streak of a mote (s).
const MOTE_STREAK_SECS: f32 = 0.011;
// Concentration at which every mote is shown.
const FULL_DUST: f32 = 0.9;
// Concentration at which a puff has 63 % of its maximum opacity.
const THICK_DUST: f32 = 1.5;
// Maximum opacity of a puff.
const PUFF_OPACITY: f32 = 0.42;

// Turbulence finer than the wind's cells, for motes (m/s).
fn flutter(wind: vec3<f32>, own: f32) -> vec3<f32> {
    let phase = own * 61.0 + frame.time_secs * vec3<f32>(1.7, 2.3, 1.3) * (0.7 + 0.6 * fract(own * 17.0));
    return sin(phase + vec3<f32>(0.0, 2.1, 4.2)) * (0.10 + 0.07 * length(wind)) * vec3<f32>(1.0, 0.6, 1.0);
}

// Brightness of dust, which scatters sunlight mostly forward.
fn scattered(toward_sun: f32) -> f32 {
    let ahead = max(toward_sun, 0.0);
    return 0.22 + 0.22 * ahead * ahead + 0.75 * pow(ahead, 9.0);
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn blow(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = id.x;
    if index >= drift.puffs + drift.motes {
        return;
    }
    let is_puff = index < drift.puffs;
    var place = places[index].at_m;
    let own = places[index].random;
    let side_m = select(drift.mote_square_m, drift.puff_square_m, is_puff);
    let size_m = select(MOTE_M * (0.5 + own), PUFF_M * (0.7 + 0.6 * own), is_puff);

    // Advection by the wind, between ground and top and within the square.
    let wind = wind_at(place, place.y);
    let velocity = wind + select(flutter(wind, own), vec3<f32>(0.0), is_puff);
    place += velocity * drift.step_secs;
    let low = select(0.1, 0.25 * PUFF_M, is_puff);
    let top = max(drift.top_m, low + 1.0);
    place.y = clamp(top - abs(top - (low + abs(place.y - low))), low, top);
    let from_eye = place.xz - frame.eye_m.xz;
    let offset = from_eye - side_m * round(from_eye / side_m);
    place.x = frame.eye_m.x + offset.x;
    place.z = frame.eye_m.z + offset.y;
    places[index].at_m = place;

    var sprite: Sprite;
    let air = air_at(place.xz, place.y);
    let dust = dust_of(air);
    let centre = vec3<f32>(place.x, ground_height(place.xz) + place.y, place.z);
    let to = centre - frame.eye_m;
    let distance_m = max(length(to), 1e-3);
    let view = to / distance_m;
    let rim = 1.0 - smoothstep(0.34, 0.5, length(offset) / side_m);
    let near = smoothstep(0.15, 0.30, distance_m / select(3.0, 30.0, is_puff));
    let least_m = 0.75 * distance_m * frame.pixel_rad;
    var opacity = rim * near;
    if is_puff {
        opacity *= PUFF_OPACITY * (1.0 - exp(-dust / THICK_DUST)) * (0.6 + 0.4 * own);
    } else {
        // The number of motes follows the concentration; motes smaller than a pixel are fainter in proportion.
        opacity *= smoothstep(own * FULL_DUST, (own + 0.3) * FULL_DUST, dust) * min(size_m / least_m, 1.0);
    }
    if opacity > 0.002 {
        let across = velocity - view * dot(velocity, view);
        let half_m = max(size_m, least_m);
        let streak_m = half_m + 0.5 * length(across) * MOTE_STREAK_SECS;
        let level = normalize(cross(view, vec3<f32>(0.0, 1.0, 0.0)) + vec3<f32>(1e-5, 0.0, 0.0));
        let streak = select(level, across / max(length(across), 1e-3), length(across) > 0.05);
        sprite.half_length_m = select(streak * streak_m, level * size_m * 1.5, is_puff);
        sprite.half_width_m = select(half_m, size_m * 0.7, is_puff);
        let albedo = select(vec3<f32>(1.0, 0.94, 0.80), vec3<f32>(0.95, 0.78, 0.52), is_puff);
        let sun_light = cloud_light(centre.xz) * sun_visible(centre);
        let toward_sun = dot(view, frame.toward_sun);
        let direct = frame.sun_rgb * (sun_light * scattered(toward_sun) * select(2.2, 1.0, is_puff));
        sprite.color = hazed(albedo * (direct + ambient(vec3<f32>(0.0, 1.0, 0.0)) * 0.6 + lamps_on(centre, -view, 1.0)), centre);
        sprite.random = own;
        sprite.centre_m = centre;
        sprite.opacity = opacity;
    }
    drawn[index] = sprite;
}

struct Speck {
    @builtin(position) position: vec4<f32>,
    // -1..1 across the sprite.
    @location(0) uv: vec2<f32>,
    // Lit colour; opacity.
    @location(1) color: vec4<f32>,
    // Height above the ground (m), random number 0..1; 1 for a puff.
    @location(2) soft: vec3<f32>,
}

@vertex
fn vs(@builtin(vertex_index) vertex: u32) -> Speck {
    let index = vertex / 6u;
    let corner = array<u32, 6>(0u, 1u, 2u, 2u, 1u, 3u)[vertex % 6u];
    let sprite = sprites[index];
    var out: Speck;
    out.position = vec4<f32>(0.0, 0.0, 0.0, 1.0);
    if sprite.opacity <= 0.0 {
        return out;
    }
    out.uv = vec2<f32>(f32(corner & 1u), f32(corner >> 1u)) * 2.0 - 1.0;
    let view = normalize(sprite.centre_m - frame.eye_m);
    let across = normalize(cross(sprite.half_length_m, view)) * sprite.half_width_m;
    let p = sprite.centre_m + sprite.half_length_m * out.uv.x + across * out.uv.y;
    let is_puff = index < drift.puffs;
    out.color = vec4<f32>(sprite.color, sprite.opacity);
    out.soft = vec3<f32>(p.y - ground_height(p.xz), sprite.random, f32(is_puff));
    out.position = frame.projection_from_world * vec4<f32>(p, 1.0);
    return out;
}

@fragment
fn fs(speck: Speck) -> @location(0) vec4<f32> {
    let inside = max(1.0 - dot(speck.uv, speck.uv), 0.0);
    var opacity = speck.color.a * inside;
    if speck.soft.z > 0.5 {
        // A ragged edge, and no hard line where a puff meets the ground.
        let torn = noise(speck.uv * 0.11 + vec2<f32>(speck.soft.y * 7.0, speck.soft.y * 3.0));
        opacity *= inside * (0.35 + 1.3 * torn.r) * smoothstep(-0.2, 1.4, speck.soft.x);
    }
    return vec4<f32>(speck.color.rgb * opacity, opacity);
}
