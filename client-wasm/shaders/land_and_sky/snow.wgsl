// Snow on the land: its surface, its light, and its weight on plants.

import package::constants::{PACKED_SNOW_ALBEDO, SNOW_ALBEDO, TILE_SPACINGS};
import package::inputs::bend_atlas::{bends, field_fraction};
import package::inputs::frame::{frame, repeated};
import package::inputs::lamps::lamps_on;
import package::inputs::sward_shade::SwardShade;
import package::land_and_sky::grass_light::sun_in_grass;
import package::land_and_sky::sky_light::ambient;
import package::land_and_sky::sward::{leaf_area_of, VISIBLE_LEAF_EXTINCTION};
import package::uniforms::Kind;

// Whether snow lies on the land.
override has_snow: bool = false;

// Difference in depth from undisturbed snow (m) at a position, in a mip level of the atlas.
fn snow_difference(p: vec2<f32>, level: f32) -> f32 {
    return textureSampleLevel(bends, repeated, p / frame.bend_window_m, 0, level).w * field_fraction(p);
}

// Depth of the snow (m).
fn snow_depth(p: vec2<f32>, level: f32) -> f32 {
    return max(frame.snow_m + snow_difference(p, level), 0.0);
}

// Side of a cell of the field (m).
fn snow_cell_m() -> f32 {
    return frame.bend_window_m / f32(textureDimensions(bends).x);
}

// Depth at a vertex of the ground, smoothed as its tiles are spaced at this distance. It is a function of the position alone, so that tiles meet.
fn depth_of_vertex(p: vec2<f32>) -> f32 {
    if !has_snow {
        return 0.0;
    }
    let spacing_m = distance(p, frame.eye_m.xz) / TILE_SPACINGS;
    return snow_depth(p, max(log2(spacing_m / snow_cell_m()), 0.0));
}

// Mass of a plant with its snow, relative to its own. Twin of `laden_mass` in shared/src/plant/snow_load.rs.
fn laden_mass(difference_m: f32) -> f32 {
    return 1.0 + frame.snow_load * clamp(1.0 + difference_m / max(frame.snow_m, 1e-3), 0.0, 1.0);
}

// Mass of a plant at a position, relative to its own.
fn laden_mass_at(p: vec2<f32>) -> f32 {
    if !has_snow {
        return 1.0;
    }
    return laden_mass(snow_difference(p, 0.0));
}

// Normal of the surface over land of normal `up`.
fn snow_normal(p: vec2<f32>, level: f32, up: vec3<f32>) -> vec3<f32> {
    let step_m = snow_cell_m() * exp2(level);
    let x = vec2<f32>(step_m, 0.0);
    let east = snow_difference(p + x, level) - snow_difference(p - x, level);
    let south = snow_difference(p + x.yx, level) - snow_difference(p - x.yx, level);
    return normalize(up - vec3<f32>(east, 0.0, south) / (2.0 * step_m));
}

// Light of the surface: diffuse, less where it is packed. `light` is the fraction of unshadowed sunlight.
fn snow_light(at: vec3<f32>, normal: vec3<f32>, difference_m: f32, light: f32) -> vec3<f32> {
    let packed = clamp(-difference_m / max(frame.snow_m, 1e-3), 0.0, 1.0);
    let direct = frame.sun_rgb * (light * max(dot(normal, frame.toward_sun), 0.0));
    return mix(SNOW_ALBEDO, PACKED_SNOW_ALBEDO, packed) * (direct + ambient(normal) + lamps_on(at, normal, 0.0));
}

// Fraction of grass of a kind that stands out of snow of this depth.
fn out_of_snow(kind: Kind, depth_m: f32) -> f32 {
    return clamp(1.0 - depth_m / kind.height_m, 0.0, 1.0);
}

// Fraction of the snow's surface that grass seen from afar hides, by the area of its leaves above the surface.
fn hidden_by_grass(kind: Kind, depth_m: f32, view: vec3<f32>, up: vec3<f32>) -> f32 {
    let leaf_area = leaf_area_of(kind) * out_of_snow(kind, depth_m);
    return 1.0 - exp(-VISIBLE_LEAF_EXTINCTION * leaf_area / clamp(-dot(view, up), 0.05, 1.0));
}

// Fraction of sunlight that the grass leaves to the surface of snow of this depth.
fn sun_on_snow(kind: Kind, depth_m: f32, shade: SwardShade) -> f32 {
    return sun_in_grass(1.0 - out_of_snow(kind, depth_m), kind, shade, depth_m / shade.height_m);
}

// Colour around a plant: the far look of the grass there, and the snow that it does not hide. `light` is the fraction of unshadowed sunlight.
fn with_snow(grass: vec3<f32>, at: vec3<f32>, normal: vec3<f32>, kind: Kind, view: vec3<f32>, light: f32, shade: SwardShade) -> vec3<f32> {
    if !has_snow {
        return grass;
    }
    let difference_m = snow_difference(at.xz, 0.0);
    let depth_m = max(frame.snow_m + difference_m, 0.0);
    let snow = snow_light(at, normal, difference_m, light * sun_on_snow(kind, depth_m, shade));
    return mix(snow, grass, hidden_by_grass(kind, depth_m, view, normal));
}
