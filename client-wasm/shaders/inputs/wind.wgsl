// Sampling of the streamed wind, and gusts finer than its cells.

import package::constants::{
    BEND_SATURATES_M_PER_S, BROAD_GUST_ACROSS_M, BROAD_GUST_M, DUST_FULL, FINE_GUST_ACROSS_M, FINE_GUST_M, WIND_FULL_M_PER_S,
};
import package::inputs::frame::{frame, runtime_zero, repeated};
import package::inputs::noise::noise;
import package::inputs::random::hash3;

@group(0) @binding(5) var winds: texture_3d<f32>;

// Wind (m/s), and square root of the dust concentration relative to `DUST_FULL`, at a position in the wind domain.
fn air_in_box(place_m: vec3<f32>) -> vec4<f32> {
    let edge = 0.5 / vec3<f32>(textureDimensions(winds));
    let uvw = place_m / frame.wind_box_m;
    let held = clamp(uvw, edge, 1.0 - edge);
    let at = select(held, uvw, vec3<bool>(frame.wind_repeats.x != 0u, false, frame.wind_repeats.y != 0u));
    return textureSampleLevel(winds, repeated, at, 0.0) * vec4<f32>(vec3<f32>(WIND_FULL_M_PER_S), 1.0);
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

fn wind_at(p: vec3<f32>, above_m: f32) -> vec3<f32> {
    return air_at(p.xz, above_m).xyz;
}

// Dust concentration of a sample of `air_at`.
fn dust_of(air: vec4<f32>) -> f32 {
    return air.w * air.w * DUST_FULL;
}

// Gust factor, about 1: gust fronts finer than the solver's cells, which travel with the mean wind.
fn gust_at(p: vec2<f32>) -> f32 {
    let along = dot(p, frame.wind_direction) - frame.gust_travel_m;
    let across = dot(p, vec2<f32>(-frame.wind_direction.y, frame.wind_direction.x));
    let broad = noise(vec2<f32>(along / BROAD_GUST_M, across / BROAD_GUST_ACROSS_M)).r;
    let fine = noise(vec2<f32>(along / FINE_GUST_M, across / FINE_GUST_ACROSS_M)).g;
    return 0.45 + 1.35 * smoothstep(0.28, 0.74, broad * 0.62 + fine * 0.38);
}

// Lean (rad, as a vector on the ground) in a steady wind, for a plant that a wind of `BEND_SATURATES_M_PER_S` bends by `bend_rad`.
// Twin of `wind_lean_rad` in shared/src/bend/wind.rs.
fn lean_of_wind(wind: vec2<f32>, bend_rad: f32) -> vec2<f32> {
    let speed = length(wind);
    let fraction = min(speed, BEND_SATURATES_M_PER_S) * (1.0 / BEND_SATURATES_M_PER_S);
    return wind / max(speed, 1e-3) * (bend_rad * fraction * fraction);
}
