// Rain and snowfall: streaks of drops or flakes around the camera that fall at their own speed and drift with the wind. Their positions are functions of their
// number and the time.

import package::inputs::frame::frame;
import package::inputs::random::random3;
import package::land_and_sky::ground::ground_height;
import package::land_and_sky::sky_light::ambient;
import package::uniforms::Shower;

@group(1) @binding(0) var<uniform> shower: Shower;

struct Streak {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(linear) across: f32,
    @location(1) opacity: f32,
}

@vertex
fn vs(@builtin(vertex_index) index: u32) -> Streak {
    let drop = index / 6u;
    let corner = array<u32, 6>(0u, 1u, 2u, 2u, 1u, 3u)[index % 6u];
    let own = random3(vec2<i32>(i32(drop), 3), 211u);
    let side = shower.side_m;
    let tall = shower.height_m;
    let speed = shower.fall_m_per_s * (0.85 + 0.3 * fract(own.x * 31.0));
    let wind = frame.wind_direction * frame.mean_wind_m_per_s;
    let velocity = vec3<f32>(wind.x, -speed, wind.y);
    let moved = own * vec3<f32>(side, tall, side) + velocity * frame.time_secs;
    // Wrapped into the box around the eye.
    let size = vec3<f32>(side, tall, side);
    let low = frame.eye_m - 0.5 * size;
    let centre = low + fract((moved - low) / size) * size;
    let along = normalize(velocity);
    let to = centre - frame.eye_m;
    let distance_m = length(to);
    let across = normalize(cross(along, to));
    let half_width = max(shower.half_width_m, 0.6 * distance_m * frame.pixel_rad);
    let end = f32(corner >> 1u) - 0.5;
    let side_of = f32(corner & 1u) * 2.0 - 1.0;
    let p = centre + velocity * (shower.streak_secs * end) + across * (half_width * side_of);
    var out: Streak;
    out.across = side_of;
    // Streaks thinner than a pixel are fainter; there are none at the rim of the box or below the ground.
    let rim = 1.0 - smoothstep(0.35, 0.5, max(abs(to.x), abs(to.z)) / side);
    let thin = shower.half_width_m / half_width;
    let is_above = select(0.0, 1.0, centre.y > ground_height(centre.xz));
    out.opacity = shower.opacity * (0.25 + 0.75 * thin) * rim * is_above * smoothstep(0.5, 1.0, distance_m);
    out.position = select(vec4<f32>(0.0, 0.0, 0.0, 1.0), frame.projection_from_world * vec4<f32>(p, 1.0), out.opacity > 0.0);
    return out;
}

@fragment
fn fs(streak: Streak) -> @location(0) vec4<f32> {
    // `across` is extrapolated at the border of a streak, where only some samples of a pixel are in it.
    let opacity = streak.opacity * max(1.0 - streak.across * streak.across, 0.0);
    let light = ambient(vec3<f32>(0.0, 1.0, 0.0)) * 1.3;
    return vec4<f32>(light * opacity, opacity);
}
