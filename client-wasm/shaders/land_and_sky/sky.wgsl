// Sky: scattered light, the discs of sun and moon, clouds and stars, drawn where nothing else is.

import package::constants::{SKY_HEADINGS, SKY_RINGS, TAU};
import package::inputs::frame::frame;
import package::inputs::noise::noise;
import package::inputs::random::random3;
import package::land_and_sky::sky_light::{haze_phase, sky_parts, sun_heading};

// Whether stars are visible, and whether rain clouds are. Fixed at pipeline creation, since software drivers execute both sides of a branch.
override has_stars: bool = true;
override has_rain_clouds: bool = true;

// A dome at infinity: what varies slowly is found at its vertices, what the phase function of haze, the sun and clouds make of it at each pixel.
struct Ray {
    @builtin(position) position: vec4<f32>,
    @location(0) direction: vec3<f32>,
    // `SkyParts` in this direction.
    @location(1) steady: vec3<f32>,
    @location(2) haze: vec3<f32>,
}

// Angular radius of the drawn disc of the sun (rad), and its brightness relative to the light it casts: far below the true one, but brighter
// than white.
const DRAWN_DISC_RAD: f32 = 0.0065;
const DISC_BRIGHTNESS: f32 = 60.0;
// Angular radius of the drawn moon (rad): twice the true one, as it seems to an eye.
const DRAWN_MOON_RAD: f32 = 0.0095;
// Cells along the side of each face of a cube; each holds one star.
const STAR_CELLS: f32 = 90.0;

// The first ring is straight below; the others rise from the horizon in equal steps of the square root of the sine of their elevation, as the rows of the sky's table do.
@vertex
fn vs(@builtin(vertex_index) index: u32) -> Ray {
    let ring = index / (SKY_HEADINGS + 1u);
    let above = f32(max(ring, 1u) - 1u) / f32(SKY_RINGS - 2u);
    let up = select(above * above, -1.0, ring == 0u);
    // The last heading is the first one, to the bit.
    let turn = f32((index % (SKY_HEADINGS + 1u)) % SKY_HEADINGS) * (TAU / f32(SKY_HEADINGS));
    let sun = sun_heading();
    let level = vec2<f32>(cos(turn) * sun.x - sin(turn) * sun.y, cos(turn) * sun.y + sin(turn) * sun.x) * sqrt(max(1.0 - up * up, 0.0));
    let direction = vec3<f32>(level.x, up, level.y);
    let parts = sky_parts(direction);
    var ray: Ray;
    let place = frame.projection_from_world * vec4<f32>(direction, 0.0);
    ray.position = vec4<f32>(place.xy, 0.0, place.w);
    ray.direction = direction;
    ray.steady = parts.steady;
    ray.haze = parts.haze;
    return ray;
}

// Thickness of the clouds above a position, 0..1, from their broad forms and the fraction of their fine ones.
fn cloud_density(at: vec2<f32>, fine: f32) -> f32 {
    let broad = noise(at / 6100.0);
    return smoothstep(0.52, 0.80, broad.r * 0.55 + broad.g * 0.20 + broad.b * 0.13 + fine * 0.12);
}

// Disc of the sun with limb darkening (u = 0.6, for green light).
fn sun_disc(direction: vec3<f32>) -> vec3<f32> {
    let off = (direction - frame.toward_sun) / DRAWN_DISC_RAD;
    let off2 = dot(off, off);
    let pixel = 0.5 * frame.pixel_rad / DRAWN_DISC_RAD;
    let limb = 0.4 + 0.6 * sqrt(max(1.0 - off2, 0.0));
    return frame.sun_rgb * (DISC_BRIGHTNESS * limb * (1.0 - smoothstep((1.0 - pixel) * (1.0 - pixel), (1.0 + pixel) * (1.0 + pixel), off2)));
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

// The full moon, opposite the sun: its light relative to a bright star, with its maria and the glow of the air about it; and how far it covers the stars.
fn moon(direction: vec3<f32>) -> vec2<f32> {
    let off = (direction + frame.toward_sun) / DRAWN_MOON_RAD;
    let off2 = dot(off, off);
    let east = normalize(vec3<f32>(frame.toward_sun.z, 0.0, 1e-5 - frame.toward_sun.x));
    let place = vec2<f32>(dot(off, east), dot(off, cross(east, frame.toward_sun)));
    let maria = smoothstep(0.42, 0.62, noise(place * 0.045 + 0.73).g);
    let pixel = 0.5 * frame.pixel_rad / DRAWN_MOON_RAD;
    let disc = 1.0 - smoothstep((1.0 - pixel) * (1.0 - pixel), (1.0 + pixel) * (1.0 + pixel), off2);
    return vec2<f32>(disc * (1.9 - 0.7 * maria) + 0.16 / (1.0 + 0.06 * off2), disc);
}

// Sky with clouds before it.
fn clouded(sky: vec3<f32>, direction: vec3<f32>, toward_sun: f32) -> vec3<f32> {
    let up = max(direction.y, 0.0);
    let at = frame.eye_m.xz + frame.cloud_offset_m + direction.xz / (up + 0.05) * 1500.0;
    let density = cloud_density(at, noise(at / 870.0 + 0.37).g);
    // Sunlight comes in at an angle: denser cloud on the side of the sun blocks it.
    let lit = cloud_density(at + sun_heading() * 260.0, 0.5);
    let ahead2 = toward_sun * toward_sun;
    let ahead4 = ahead2 * ahead2;
    let edge = select(0.0, ahead4 * ahead4 * ahead4, toward_sun > 0.0);
    let light = frame.lights.mean_rgb + frame.lights.up_rgb;
    let bright = frame.lights.cloud_sun_rgb * (0.44 + 0.6 * edge) + light * 0.6;
    let shade = frame.lights.cloud_sun_rgb * 0.085 + light * 0.75;
    let cloud = mix(bright, shade, clamp(lit * 0.85 + density * 0.15, 0.0, 1.0) * (1.0 - 0.5 * edge));
    return mix(sky, cloud, density * 0.9 * smoothstep(0.015, 0.16, direction.y) * (1.0 - frame.overcast));
}

// Light of rain clouds relative to their mean: low and torn, dark where they are thick. Towards the horizon they merge.
fn rain_cloud_light(direction: vec3<f32>) -> f32 {
    let at = frame.eye_m.xz + frame.cloud_offset_m + direction.xz / (max(direction.y, 0.0) + 0.07) * 640.0;
    let broad = noise(at / 2900.0);
    let thick = broad.r * 0.5 + broad.g * 0.28 + noise(at / 690.0 + 0.61).b * 0.22;
    let light = mix(1.44, 0.56, smoothstep(0.36, 0.64, thick));
    return mix(1.0, light, smoothstep(0.01, 0.22, direction.y));
}

@fragment
fn fs(ray: Ray) -> @location(0) vec4<f32> {
    let direction = normalize(ray.direction);
    let toward_sun = dot(direction, frame.toward_sun);
    let clear = 1.0 - frame.overcast;
    var color = ray.steady + ray.haze * haze_phase(toward_sun) + sun_disc(direction) * clear;
    if has_stars {
        let night = frame.lights.star_brightness * clear;
        let moon = moon(direction);
        color += vec3<f32>(0.85, 0.92, 1.05) * (stars(direction) * (1.0 - moon.y) * night * smoothstep(0.0, 0.25, direction.y));
        color += vec3<f32>(1.0, 0.97, 0.9) * (moon.x * night * smoothstep(-0.005, 0.03, direction.y));
    }
    color = clouded(color, direction, toward_sun);
    if has_rain_clouds {
        color *= mix(1.0, rain_cloud_light(direction), frame.overcast);
    }
    return vec4<f32>(color, 1.0);
}
