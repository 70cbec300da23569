// Light of sky and land. Colours are in picture units: illuminance divided by π, or luminance, times the exposure.

import package::constants::{HAZE_FORWARD, LUMINANCE, TAU};
import package::inputs::frame::{clamped, frame};

@group(0) @binding(13) var sky_table: texture_2d<f32>;

fn haze_phase(cosine: f32) -> f32 {
    let under = 1.0 + HAZE_FORWARD * HAZE_FORWARD - 2.0 * HAZE_FORWARD * cosine;
    return (1.0 - HAZE_FORWARD * HAZE_FORWARD) / (2.0 * TAU * under * sqrt(under));
}

// Unit vector on the ground towards the sun.
fn sun_heading() -> vec2<f32> {
    return frame.lights.sun_heading;
}

// Luminance of the sky in a direction, in two parts that vary slowly with it: without haze; by haze, divided by its phase function.
struct SkyParts {
    steady: vec3<f32>,
    haze: vec3<f32>,
}

// The upper half of the table holds scattering by molecules, the lower half scattering by haze, divided by its phase function.
fn sky_parts(direction: vec3<f32>) -> SkyParts {
    let up = clamp(direction.y, 0.0, 1.0);
    let level = direction.xz / max(length(direction.xz), 1e-4);
    let size = vec2<f32>(textureDimensions(sky_table)) * vec2<f32>(1.0, 0.5);
    let place = vec2<f32>(sqrt(clamp(0.5 - 0.5 * dot(level, sun_heading()), 0.0, 1.0)), sqrt(up));
    let uv = (place * (size - 1.0) + 0.5) / (size * vec2<f32>(1.0, 2.0));
    let molecules = textureSampleLevel(sky_table, clamped, uv, 0.0).rgb;
    let haze = textureSampleLevel(sky_table, clamped, uv + vec2<f32>(0.0, 0.5), 0.0).rgb;
    // Rain clouds are grey in all directions, a little brighter at the horizon.
    let grey = dot(frame.lights.mean_rgb + frame.lights.up_rgb, LUMINANCE);
    let overcast = vec3<f32>(0.94, 0.99, 1.06) * (grey * mix(1.0, 0.68, sqrt(up)));
    return SkyParts(mix(molecules + frame.lights.night_rgb, overcast, frame.overcast), haze * (1.0 - frame.overcast));
}

// Luminance of the sky in a direction. Twin of `Sky::luminance` in shared/src/light/sky.rs.
fn sky_color(direction: vec3<f32>) -> vec3<f32> {
    let parts = sky_parts(direction);
    return parts.steady + parts.haze * haze_phase(dot(direction, frame.toward_sun));
}

// Light of sky and land on a surface, divided by π. Twin of `Sky::ambient`.
fn ambient(normal: vec3<f32>) -> vec3<f32> {
    return frame.lights.mean_rgb + frame.lights.up_rgb * normal.y + frame.lights.toward_sun_rgb * dot(normal.xz, sun_heading());
}
