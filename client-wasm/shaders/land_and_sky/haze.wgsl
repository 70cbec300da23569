// Haze and mist between the eye and a visible point.

import package::inputs::frame::frame;
import package::land_and_sky::sky_light::sky_color;

// Scale height of haze near the ground (m), above the lowest land. Differs from that of the sky's aerosols, `HAZE_HEIGHT_M` in
// shared/src/light/air.rs.
const GROUND_HAZE_HEIGHT_M: f32 = 700.0;

// Optical depth of a path through air that thins out exponentially, relative to the same length at height 0. The path begins at `low` and
// rises by `rise` scale heights.
fn thinned_depth(low: f32, rise: f32) -> f32 {
    let even = exp(-clamp(low, -4.0, 60.0));
    if abs(rise) < 0.01 {
        return even * (1.0 - 0.5 * rise);
    }
    return even * (1.0 - exp(-clamp(rise, -20.0, 60.0))) / rise;
}

// In-scattered light and transmittance of the air in front of a position: haze shows the sky behind it, warm and bright around the sun;
// mist on low land is lit from all sides.
fn air_before(p: vec3<f32>) -> vec4<f32> {
    let to = p - frame.eye_m;
    let distance_m = length(to);
    let direction = to / max(distance_m, 1e-3);
    let above_m = frame.eye_m.y - frame.lights.mist_ground_m;
    let depth = distance_m / frame.haze_distance_m * thinned_depth(above_m / GROUND_HAZE_HEIGHT_M, to.y / GROUND_HAZE_HEIGHT_M);
    let behind = sky_color(normalize(vec3<f32>(direction.x, max(direction.y, 0.0) + 0.03, direction.z)));
    // After sunset the glow is high up: the air near the ground is lit by the whole sky.
    let around = frame.lights.mean_rgb + frame.lights.up_rgb * 0.6;
    let air = mix(around, behind, 0.3 + 0.7 * smoothstep(-0.04, 0.10, frame.toward_sun.y));
    let through = exp(-depth);
    let mist = exp(-distance_m * frame.lights.mist_per_m * thinned_depth(above_m / frame.lights.mist_height_m, to.y / frame.lights.mist_height_m));
    let ahead = max(dot(direction, frame.toward_sun), 0.0);
    let ahead2 = ahead * ahead;
    let lit = (frame.lights.mean_rgb + frame.lights.up_rgb * 0.5) * 0.95 + frame.sun_rgb * (0.10 + 0.45 * ahead2 * ahead2 * ahead2);
    return vec4<f32>(mix(lit, air * (0.93 * (1.0 - through)), mist), through * mist);
}

// Colour of a position as seen through the air.
fn hazed(color: vec3<f32>, p: vec3<f32>) -> vec3<f32> {
    let air = air_before(p);
    return color * air.a + air.rgb;
}
