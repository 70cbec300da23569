// Sampling of the streamed wind, and gusts finer than its cells. Twin of `WindField` in shared/src/wind/field.rs.

import package::constants::{BEND_SATURATES_M_PER_S, FREE_WIND_M, LEAST_WIND_HEIGHT, TAU};
import package::inputs::frame::{frame, runtime_zero, repeated};
import package::inputs::random::hash3;

@group(0) @binding(5) var winds: texture_3d<f32>;

// Wind (m/s), and square root of the dust concentration, at a position in the wind domain.
fn air_in_box(place_m: vec3<f32>) -> vec4<f32> {
    let edge = 0.5 / vec3<f32>(textureDimensions(winds));
    let uvw = place_m / frame.wind_box_m;
    let held = clamp(uvw, edge, 1.0 - edge);
    let at = select(held, uvw, vec3<bool>(frame.wind_repeats.x != 0u, false, frame.wind_repeats.y != 0u));
    return textureSampleLevel(winds, repeated, at, 0.0);
}

// Offset (cells along X and Z) of the wind domain in a patch. Twin of `offset_cells` in shared/src/wind/tiling.rs.
fn offset_cells(patch_place: vec2<i32>, cells: vec2<u32>) -> vec2<u32> {
    let hash = hash3(vec3<u32>(bitcast<u32>(patch_place.x), bitcast<u32>(patch_place.y), frame.patch_seed));
    return (hash.xy >> vec2<u32>(8u)) % cells;
}

// Wind and dust at a height above `p`, with the wind domain tiled over the world. Twin of `Tiles::taps` in shared/src/wind/tiling.rs.
fn air_at(p: vec2<f32>, above_m: f32) -> vec4<f32> {
    let is_one_box = frame.wind_patch_m <= runtime_zero(p.x);
    let patch_m = max(frame.wind_patch_m, 1.0);
    let cells = textureDimensions(winds).xz;
    let spacing_m = frame.wind_box_m.xz / vec2<f32>(cells);
    let at = p / patch_m - 0.5;
    let low = floor(at);
    let far = clamp((at - low - 0.5) * patch_m / spacing_m + 0.5, vec2<f32>(0.0), vec2<f32>(1.0));
    var air = vec4<f32>(0.0);
    for (var i = 0; i < select(4, 1, is_one_box); i++) {
        let corner = vec2<i32>(i & 1, i >> 1u);
        let fractions = select(1.0 - far, far, corner == vec2<i32>(1));
        let moved = vec2<f32>(offset_cells(vec2<i32>(low) + corner, cells)) * spacing_m;
        let at = p + select(moved, vec2<f32>(0.0), is_one_box);
        air += air_in_box(vec3<f32>(at.x, above_m, at.y)) * select(fractions.x * fractions.y, 1.0, is_one_box);
    }
    return air;
}

// The solver's wind (m/s) at a height above `p`.
fn resolved_at(p: vec3<f32>, above_m: f32) -> vec3<f32> {
    return air_at(p.xz, above_m).xyz;
}

// Gust (m/s, along X and Z): the turbulence that the solver's cells do not resolve. Twin of `Gusts::at` in shared/src/wind/turbulence.rs.
fn gust_at(p: vec2<f32>) -> vec2<f32> {
    var gust = vec2<f32>(0.0);
    let count = frame.gust_count + u32(runtime_zero(p.x));
    for (var i = 0u; i < count; i++) {
        let wave = frame.gusts[i];
        let speed = wave.strength * cos(TAU * fract(dot(wave.per_m, p) + wave.phase));
        gust += vec2<f32>(-wave.per_m.y, wave.per_m.x) * speed;
    }
    return gust;
}

// Wind over the ground (m/s, along X and Z) in the lowest cells, with its gust.
fn ground_wind_at(ground: vec3<f32>) -> vec2<f32> {
    return resolved_at(ground, 0.0).xz + gust_at(ground.xz);
}

// Wind with its gust (m/s) at a height above `p`, reduced near the ground. Twin of `WindField::wind_at`.
fn wind_at(p: vec3<f32>, above_m: f32) -> vec3<f32> {
    let gust = gust_at(p.xz);
    return (resolved_at(p, above_m) + vec3<f32>(gust.x, 0.0, gust.y)) * near_ground_fraction(above_m);
}

// Wind speed at a height, relative to that at `FREE_WIND_M`: a quarter-power law. Twin of the function in shared/src/wind/ground.rs.
fn near_ground_fraction(above_m: f32) -> f32 {
    return sqrt(sqrt(clamp(above_m / FREE_WIND_M, LEAST_WIND_HEIGHT, 1.0)));
}

// Dust concentration of a sample of `air_at`.
fn dust_of(air: vec4<f32>) -> f32 {
    return air.w * air.w;
}

// Lean (rad, as a vector on the ground) in a steady wind, for a plant that a wind of `BEND_SATURATES_M_PER_S` bends by `bend_rad`.
// Twin of `wind_lean_rad` in shared/src/bend/wind.rs.
fn lean_of_wind(wind: vec2<f32>, bend_rad: f32) -> vec2<f32> {
    let speed = length(wind);
    let fraction = min(speed, BEND_SATURATES_M_PER_S) * (1.0 / BEND_SATURATES_M_PER_S);
    return wind / max(speed, 1e-3) * (bend_rad * fraction * fraction);
}
