// Dust carried by the streamed wind: motes near the camera, and soft puffs of haze where the air is dusty. Motes drift in a square that moves with the
// camera: those that leave it on one side enter again on the other. Puffs live for seconds, and start in dusty cells of the wind.

import package::constants::{DUSTY_CELLS, FULL_PUFFS_DUST, WORKGROUP_SIZE};
import package::inputs::frame::frame;
import package::inputs::lamps::lamps_on;
import package::inputs::noise::noise;
import package::inputs::random::random3;
import package::inputs::shadows::sun_visible;
import package::inputs::wind::{air_at, dust_of, offset_cells, wind_at, winds};
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
    // Age of a puff, relative to its life: at 1 it may start again; 2 before its first life.
    age: f32,
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
// Cells of the wind domain, in proportion to the puffs that belong there.
@group(1) @binding(4) var<storage, read> dusty_cells: array<u32>;

// Half-width of a mote (m).
const MOTE_M: f32 = 0.010;
// Exposure time of the streak of a mote (s).
const MOTE_STREAK_SECS: f32 = 0.011;
// Concentration at which every mote is shown.
const FULL_DUST: f32 = 0.9;
// Share of light that a metre of air with concentration 1 scatters out of a ray (1/m).
const EXTINCTION_PER_M: f32 = 0.05;
// Size of a puff, relative to the side of a cube of the air that it stands for.
const PUFF_PER_SIDE: f32 = 0.95;
// Half-length and half-width of a puff, relative to its size.
const PUFF_LENGTH: f32 = 1.2;
const PUFF_WIDTH: f32 = 0.85;
// Mean opacity of a puff over its life and the square of its half-axes, relative to the opacity of its centre: pi / 3 of the outline, 0.7 of the life.
const OPAQUE_SHARE: f32 = 0.73;
// Largest size of a puff of mean random number in the middle of its life (m).
const LARGEST_PUFF_M: f32 = 5.0;
// Mean life of a puff (s).
const PUFF_SECS: f32 = 5.0;

// Turbulence finer than the wind's cells, for motes (m/s).
fn flutter(wind: vec3<f32>, own: f32) -> vec3<f32> {
    let phase = own * 61.0 + frame.time_secs * vec3<f32>(1.7, 2.3, 1.3) * (0.7 + 0.6 * fract(own * 17.0));
    return sin(phase + vec3<f32>(0.0, 2.1, 4.2)) * (0.10 + 0.07 * length(wind)) * vec3<f32>(1.0, 0.6, 1.0);
}

// Brightness of dust, which scatters sunlight mostly forward.
fn scattered(toward_sun: f32) -> f32 {
    let ahead = max(toward_sun, 0.0);
    return 0.34 + 0.22 * ahead * ahead + 0.75 * pow(ahead, 9.0);
}

// Sunlight that reaches a point of dusty air, above the ground at its own height.
fn through_dust(place: vec3<f32>) -> f32 {
    var concentration_m = 0.0;
    var from_m = 1.0;
    for (var i = 0; i < 4; i++) {
        let at = place + frame.toward_sun * (from_m * 1.5);
        concentration_m += from_m * dust_of(air_at(at.xz, at.y)) * select(0.0, 1.0, at.y < frame.wind_box_m.y);
        from_m *= 2.0;
    }
    // Light that is scattered several times still arrives.
    return 0.4 + 0.6 * exp(-EXTINCTION_PER_M * concentration_m);
}

// Whether the wind domain repeats along X and Z.
fn repeats() -> vec2<bool> {
    return (frame.wind_repeats != vec2<u32>(0u)) | vec2<bool>(frame.wind_patch_m > 0.0);
}

fn patch_of(p: vec2<f32>) -> vec2<i32> {
    return vec2<i32>(floor(p / max(frame.wind_patch_m, 1.0)));
}

// A random place in a dusty cell (X, height above the ground, Z in m), in one of the images of the wind domain around the camera; 0 as fourth component if it lies in
// another patch than the one whose offset was tried.
fn started(index: u32) -> vec4<f32> {
    let seed = vec2<i32>(i32(index), bitcast<i32>(frame.time_secs));
    let pick = random3(seed, 0u);
    let cells = textureDimensions(winds);
    let cell = dusty_cells[min(u32(pick.x * f32(DUSTY_CELLS)), DUSTY_CELLS - 1u)];
    let corner = vec3<u32>(cell % cells.x, cell / cells.x % cells.y, cell / (cells.x * cells.y));
    // Linear interpolation between the centres of cells.
    let at = vec3<f32>(corner) - 0.5 + random3(seed, 1u) + random3(seed, 2u);
    var place = at / vec3<f32>(cells) * frame.wind_box_m;
    let box_m = frame.wind_box_m.xz;
    let by_patch = frame.wind_patch_m > 0.0;
    let near = frame.eye_m.xz + (pick.yz - 0.5) * max(drift.puff_square_m - box_m, vec2<f32>(0.0));
    let spacing_m = box_m / vec2<f32>(cells.xz);
    let moved = vec2<f32>(offset_cells(patch_of(near), cells.xz)) * spacing_m;
    let image = place.xz - select(vec2<f32>(0.0), moved, by_patch);
    let nearest = image + box_m * round((near - image) / box_m);
    let xz = select(image, nearest, repeats());
    let is_there = !by_patch | all(patch_of(xz) == patch_of(near));
    return vec4<f32>(xz.x, place.y, xz.y, select(0.0, 1.0, is_there));
}

// Colour of dust at `centre_m`, with shares of the light of sun and sky.
fn lit(centre_m: vec3<f32>, view: vec3<f32>, albedo: vec3<f32>, sun_light: f32, sky_light: f32) -> vec3<f32> {
    let direct = frame.sun_rgb * (sun_light * cloud_light(centre_m.xz) * sun_visible(centre_m) * scattered(dot(view, frame.toward_sun)));
    let indirect = ambient(vec3<f32>(0.0, 1.0, 0.0)) * sky_light + lamps_on(centre_m, -view, 1.0);
    return hazed(albedo * (direct + indirect), centre_m);
}

// Moves a puff and lights it.
fn puff(index: u32) -> Sprite {
    let own = places[index].random;
    var sprite: Sprite;
    var place = places[index].at_m;
    let before = places[index].age;
    var age = before + drift.step_secs / (PUFF_SECS * (0.6 + 0.8 * own));
    let start = started(index);
    // One that the camera has left behind.
    let reach_m = select(frame.wind_box_m.xz, 0.5 * max(vec2<f32>(drift.puff_square_m), frame.wind_box_m.xz), repeats());
    let is_lost = any(abs(place.xz - frame.eye_m.xz) > reach_m);
    if (age >= 1.0 || is_lost) && drift.puff_m3 > 0.0 && start.w > 0.0 {
        place = start.xyz;
        // The first ones are of all ages.
        age = select(0.0, random3(vec2<i32>(i32(index), 7), 0u).x, before >= 2.0);
    } else {
        place += wind_at(place, place.y) * drift.step_secs;
        age = select(min(age, 1.0), before, before >= 2.0);
    }
    let cube_side_m = pow(drift.puff_m3, 1.0 / 3.0);
    let size_m = min(PUFF_PER_SIDE * cube_side_m, LARGEST_PUFF_M) * (0.7 + 0.6 * own) * (0.75 + 0.5 * age);
    place.y = clamp(place.y, 0.3 * size_m, max(frame.wind_box_m.y, size_m));
    places[index].at_m = place;
    places[index].age = age;
    if age >= 1.0 || drift.puff_m3 <= 0.0 {
        return sprite;
    }
    let dust = dust_of(air_at(place.xz, place.y));
    let centre = vec3<f32>(place.x, ground_height(place.xz) + place.y, place.z);
    let to = centre - frame.eye_m;
    let distance_m = max(length(to), 1e-3);
    let view = to / distance_m;
    // Summed over its outline and its life, it scatters as much light as the air that it stands for.
    let area_m2 = OPAQUE_SHARE * PUFF_LENGTH * PUFF_WIDTH * size_m * size_m;
    let optical_depth = EXTINCTION_PER_M * max(dust, FULL_PUFFS_DUST) * drift.puff_m3 / area_m2;
    let share = smoothstep(0.0, 0.3 * FULL_PUFFS_DUST, dust);
    let rim = 1.0 - smoothstep(0.8, 1.0, max(abs(to.x) / reach_m.x, abs(to.z) / reach_m.y));
    let of_life = smoothstep(0.0, 0.2, age) * (1.0 - smoothstep(0.6, 1.0, age));
    let near = smoothstep(1.0, 3.0, distance_m / size_m);
    let opacity = (1.0 - exp(-optical_depth)) * share * rim * of_life * near;
    if opacity > 0.002 {
        sprite.opacity = opacity;
        let level = normalize(cross(view, vec3<f32>(0.0, 1.0, 0.0)) + vec3<f32>(1e-5, 0.0, 0.0));
        sprite.half_length_m = level * size_m * PUFF_LENGTH;
        sprite.half_width_m = size_m * PUFF_WIDTH;
        let sun_light = through_dust(place);
        sprite.color = lit(centre, view, vec3<f32>(0.95, 0.76, 0.50), sun_light, 0.20 + 0.25 * sun_light);
        sprite.random = own;
        sprite.centre_m = centre;
    }
    return sprite;
}

// Moves a mote and lights it.
fn mote(index: u32) -> Sprite {
    var place = places[index].at_m;
    let own = places[index].random;
    let size_m = MOTE_M * (0.5 + own);

    // Advection by the wind, between ground and top and within the square.
    let wind = wind_at(place, place.y);
    let velocity = wind + flutter(wind, own);
    place += velocity * drift.step_secs;
    let low = 0.1;
    let top = max(drift.top_m, low + 1.0);
    place.y = clamp(top - abs(top - (low + abs(place.y - low))), low, top);
    let from_eye = place.xz - frame.eye_m.xz;
    let offset = from_eye - drift.mote_square_m * round(from_eye / drift.mote_square_m);
    place.x = frame.eye_m.x + offset.x;
    place.z = frame.eye_m.z + offset.y;
    places[index].at_m = place;

    var sprite: Sprite;
    let dust = dust_of(air_at(place.xz, place.y));
    let centre = vec3<f32>(place.x, ground_height(place.xz) + place.y, place.z);
    let to = centre - frame.eye_m;
    let distance_m = max(length(to), 1e-3);
    let view = to / distance_m;
    let rim = 1.0 - smoothstep(0.34, 0.5, length(offset) / drift.mote_square_m);
    let near = smoothstep(0.15, 0.30, distance_m / 3.0);
    // The number of motes follows the concentration; motes smaller than a pixel are fainter in proportion.
    let least_m = 0.75 * distance_m * frame.pixel_rad;
    let opacity = rim * near * smoothstep(own * FULL_DUST, (own + 0.3) * FULL_DUST, dust) * min(size_m / least_m, 1.0);
    if opacity > 0.002 {
        sprite.opacity = opacity;
        let across = velocity - view * dot(velocity, view);
        let half_m = max(size_m, least_m);
        let streak_m = half_m + 0.5 * length(across) * MOTE_STREAK_SECS;
        let level = normalize(cross(view, vec3<f32>(0.0, 1.0, 0.0)) + vec3<f32>(1e-5, 0.0, 0.0));
        sprite.half_length_m = select(level, across / max(length(across), 1e-3), length(across) > 0.05) * streak_m;
        sprite.half_width_m = half_m;
        sprite.color = lit(centre, view, vec3<f32>(1.0, 0.94, 0.80), 2.2, 0.6);
        sprite.random = own;
        sprite.centre_m = centre;
    }
    return sprite;
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn blow(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = id.x;
    if index < drift.puffs {
        drawn[index] = puff(index);
    } else if index < drift.puffs + drift.motes {
        drawn[index] = mote(index);
    }
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
    if !(sprite.opacity > 0.0) {
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
