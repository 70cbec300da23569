// Sky: what the air scatters, the sun's disc, soft clouds and stars, drawn where nothing else is.

struct Ray {
    @builtin(position) position: vec4<f32>,
    @location(0) direction: vec3<f32>,
}

// Half the angle of the sun's disc as it is drawn (rad), and its brightness over that of what it lights: far from the true one, yet past white.
const DISC_RAD: f32 = 0.0065;
const DISC_BRIGHTNESS: f32 = 60.0;
// Stars are one to a cell of a grid over the faces of a cube, so many cells a side.
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

// The disc, darker towards its limb (u = 0.6, as of the sun in green light).
fn sun_disc(direction: vec3<f32>) -> vec3<f32> {
    let off = distance(direction, frame.sun.xyz) / DISC_RAD;
    let pixel = 0.5 * frame.screen.z / DISC_RAD;
    let limb = 1.0 - 0.6 * (1.0 - sqrt(max(1.0 - off * off, 0.0)));
    return frame.sun_color.rgb * (DISC_BRIGHTNESS * limb * (1.0 - smoothstep(1.0 - pixel, 1.0 + pixel, off)));
}

// Few bright stars and many faint ones, where the night lets them be seen.
fn stars(direction: vec3<f32>) -> f32 {
    let size = abs(direction);
    let most = max(size.x, max(size.y, size.z));
    let face = select(select(vec3<f32>(direction.yz, 0.0), vec3<f32>(direction.xz, 1.0), size.y == most), vec3<f32>(direction.xy, 2.0), size.z == most);
    let at = (face.xy / most * 0.5 + 0.5) * STAR_CELLS;
    let cell = floor(at);
    let own = random3(vec2<i32>(cell), u32(face.z) * 2u + select(0u, 1u, dot(direction, vec3<f32>(1.0)) > 0.0));
    let middle = cell + 0.2 + 0.6 * own.xy;
    let pixel = max(frame.screen.z * 0.5 * STAR_CELLS, 0.02);
    let off = distance(at, middle) / pixel;
    return exp(-0.7 * off * off) * (0.02 + 1.2 * pow(own.z, 22.0));
}

@fragment
fn fs(ray: Ray) -> @location(0) vec4<f32> {
    let direction = normalize(ray.direction);
    var color = sky_color(direction);
    let toward_sun = max(dot(direction, frame.sun.xyz), 0.0);
    let clear = 1.0 - frame.screen.w;
    color += sun_disc(direction) * clear;
    let starry = frame.lights.night.w * clear * smoothstep(0.0, 0.25, direction.y);
    if starry > 0.0 {
        color += vec3<f32>(0.85, 0.92, 1.05) * (stars(direction) * starry);
    }
    if direction.y > 0.015 && frame.screen.w < 0.95 {
        let at = frame.eye.xz + frame.clouds.xy + direction.xz / (direction.y + 0.05) * 1500.0;
        let density = cloud_density(at);
        if density > 0.003 {
            // Sunlight comes in aslant: denser cloud on the sun's side keeps it away.
            let lit = cloud_density(at + sun_heading() * 260.0);
            let edge = pow(toward_sun, 12.0);
            let sky = frame.lights.mean.rgb + frame.lights.up.rgb;
            let bright = frame.lights.cloud_sun.rgb * (0.44 + 0.6 * edge) + sky * 0.6;
            let shade = frame.lights.cloud_sun.rgb * 0.085 + sky * 0.75;
            let cloud = mix(bright, shade, clamp(lit * 0.85 + density * 0.15, 0.0, 1.0) * (1.0 - 0.5 * edge));
            let fade = smoothstep(0.015, 0.16, direction.y);
            color = mix(color, cloud, density * 0.9 * fade * clear);
        }
    }
    return vec4<f32>(color, 1.0);
}
