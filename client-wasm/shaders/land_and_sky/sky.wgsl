// Sky: scattered light, the disc of the sun, soft clouds and stars, drawn where nothing else is.

import package::inputs::frame::frame;
import package::inputs::noise::noise;
import package::inputs::random::random3;
import package::land_and_sky::sky_light::{sky_color, sun_heading};

struct Ray {
    @builtin(position) position: vec4<f32>,
    @location(0) direction: vec3<f32>,
}

// Angular radius of the drawn disc of the sun (rad), and its brightness relative to the light it casts: far below the true one, but brighter
// than white.
const DRAWN_DISC_RAD: f32 = 0.0065;
const DISC_BRIGHTNESS: f32 = 60.0;
// Cells along the side of each face of a cube; each holds one star.
const STAR_CELLS: f32 = 90.0;

@vertex
fn vs(@builtin(vertex_index) index: u32) -> Ray {
    let corner = vec2<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0);
    var ray: Ray;
    ray.position = vec4<f32>(corner, 0.0, 1.0);
    let far = frame.world_from_projection * vec4<f32>(corner, 1.0, 1.0);
    ray.direction = far.xyz;
    return ray;
}

fn cloud_density(at: vec2<f32>) -> f32 {
    var n = noise(at / 5200.0).r * 0.55;
    n += noise(at / 1700.0 + 0.37).a * 0.27;
    n += noise(at / 610.0).g * 0.12;
    n += noise(at / 190.0).r * 0.06;
    return smoothstep(0.52, 0.80, n);
}

// Disc of the sun with limb darkening (u = 0.6, for green light).
fn sun_disc(direction: vec3<f32>) -> vec3<f32> {
    let off = distance(direction, frame.toward_sun) / DRAWN_DISC_RAD;
    let pixel = 0.5 * frame.pixel_rad / DRAWN_DISC_RAD;
    let limb = 1.0 - 0.6 * (1.0 - sqrt(max(1.0 - off * off, 0.0)));
    return frame.sun_rgb * (DISC_BRIGHTNESS * limb * (1.0 - smoothstep(1.0 - pixel, 1.0 + pixel, off)));
}

// Stars, few bright and many faint, as far as the night sky is dark enough.
fn stars(direction: vec3<f32>) -> f32 {
    let size = abs(direction);
    let most = max(size.x, max(size.y, size.z));
    let face = select(select(vec3<f32>(direction.yz, 0.0), vec3<f32>(direction.xz, 1.0), size.y == most), vec3<f32>(direction.xy, 2.0), size.z == most);
    let at = (face.xy / most * 0.5 + 0.5) * STAR_CELLS;
    let cell = floor(at);
    let own = random3(vec2<i32>(cell), u32(face.z) * 2u + select(0u, 1u, dot(direction, vec3<f32>(1.0)) > 0.0));
    let middle = cell + 0.2 + 0.6 * own.xy;
    let pixel = max(frame.pixel_rad * 0.5 * STAR_CELLS, 0.02);
    let off = distance(at, middle) / pixel;
    return exp(-0.7 * off * off) * (0.02 + 1.2 * pow(own.z, 22.0));
}

@fragment
fn fs(ray: Ray) -> @location(0) vec4<f32> {
    let direction = normalize(ray.direction);
    var color = sky_color(direction);
    let toward_sun = max(dot(direction, frame.toward_sun), 0.0);
    let clear = 1.0 - frame.overcast;
    color += sun_disc(direction) * clear;
    let starry = frame.lights.star_brightness * clear * smoothstep(0.0, 0.25, direction.y);
    if starry > 0.0 {
        color += vec3<f32>(0.85, 0.92, 1.05) * (stars(direction) * starry);
    }
    if direction.y > 0.015 && frame.overcast < 0.95 {
        let at = frame.eye_m.xz + frame.cloud_offset_m + direction.xz / (direction.y + 0.05) * 1500.0;
        let density = cloud_density(at);
        if density > 0.003 {
            // Sunlight comes in at an angle: denser cloud on the side of the sun blocks it.
            let lit = cloud_density(at + sun_heading() * 260.0);
            let edge = pow(toward_sun, 12.0);
            let sky = frame.lights.mean_rgb + frame.lights.up_rgb;
            let bright = frame.lights.cloud_sun_rgb * (0.44 + 0.6 * edge) + sky * 0.6;
            let shade = frame.lights.cloud_sun_rgb * 0.085 + sky * 0.75;
            let cloud = mix(bright, shade, clamp(lit * 0.85 + density * 0.15, 0.0, 1.0) * (1.0 - 0.5 * edge));
            let fade = smoothstep(0.015, 0.16, direction.y);
            color = mix(color, cloud, density * 0.9 * fade * clear);
        }
    }
    return vec4<f32>(color, 1.0);
}
