// Rain: streaks of drops about the camera that fall with their own speed and drift with the wind. Where each is follows from its number and the time.

struct Shower {
    // Drops; unused.
    counts: vec4<u32>,
    // Side of the square that they are in, and its height (m); speed at which they fall (m/s); opacity.
    shape: vec4<f32>,
}

@group(1) @binding(0) var<uniform> shower: Shower;

// Time for which a drop leaves its streak in the eye (s); half of its width (m).
const STREAK_SECS: f32 = 0.045;
const HALF_WIDTH_M: f32 = 0.0020;

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
    let side = shower.shape.x;
    let tall = shower.shape.y;
    let speed = shower.shape.z * (0.85 + 0.3 * fract(own.x * 31.0));
    let wind = frame.gust.xy * frame.gust.z;
    let velocity = vec3<f32>(wind.x, -speed, wind.y);
    let moved = own * vec3<f32>(side, tall, side) + velocity * frame.eye.w;
    // Into the box about the eye.
    let size = vec3<f32>(side, tall, side);
    let low = frame.eye.xyz - 0.5 * size;
    let centre = low + fract((moved - low) / size) * size;
    let along = normalize(velocity);
    let to = centre - frame.eye.xyz;
    let distance_m = length(to);
    let across = normalize(cross(along, to));
    let half_width = max(HALF_WIDTH_M, 0.6 * distance_m * frame.screen.z);
    let end = f32(corner >> 1u) - 0.5;
    let side_of = f32(corner & 1u) * 2.0 - 1.0;
    let p = centre + velocity * (STREAK_SECS * end) + across * (half_width * side_of);
    var out: Streak;
    out.across = side_of;
    // Thinner than a pixel is fainter; none at the box's rim or under the ground.
    let rim = 1.0 - smoothstep(0.35, 0.5, max(abs(to.x), abs(to.z)) / side);
    let thin = HALF_WIDTH_M / half_width;
    let is_above = select(0.0, 1.0, centre.y > ground_height(centre.xz));
    out.opacity = shower.shape.w * (0.25 + 0.75 * thin) * rim * is_above * smoothstep(0.5, 1.0, distance_m);
    out.position = select(vec4<f32>(0.0, 0.0, 0.0, 1.0), frame.projection_from_world * vec4<f32>(p, 1.0), out.opacity > 0.0);
    return out;
}

@fragment
fn fs(streak: Streak) -> @location(0) vec4<f32> {
    // Not the number that it should be beside the border of a streak, where only some samples of a pixel are in it.
    let opacity = streak.opacity * max(1.0 - streak.across * streak.across, 0.0);
    let light = ambient(vec3<f32>(0.0, 1.0, 0.0)) * 1.3;
    return vec4<f32>(light * opacity, opacity);
}
