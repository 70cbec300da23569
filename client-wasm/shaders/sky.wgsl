// Sky: gradient, sun and soft clouds, drawn where nothing else is.

struct Ray {
    @builtin(position) position: vec4<f32>,
    @location(0) direction: vec3<f32>,
}

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
    return smoothstep(0.56 - 0.08 * frame.clouds.z, 0.80, n);
}

@fragment
fn fs(ray: Ray) -> @location(0) vec4<f32> {
    let direction = normalize(ray.direction);
    var color = sky_color(direction);
    let toward_sun = max(dot(direction, frame.sun.xyz), 0.0);
    color += frame.sun_color.rgb * (smoothstep(0.99955, 0.99985, toward_sun) * 12.0 + pow(toward_sun, 900.0) * 0.8);
    if direction.y > 0.015 && frame.screen.w < 0.95 {
        let at = frame.eye.xz + frame.clouds.xy + direction.xz / (direction.y + 0.05) * 1500.0;
        let density = cloud_density(at);
        if density > 0.003 {
            let lit = cloud_density(at + frame.sun.xz * 260.0);
            let edge = pow(toward_sun, 12.0);
            let bright = frame.sun_color.rgb * (0.50 + 0.5 * edge) + vec3<f32>(0.26, 0.29, 0.34);
            let shade = vec3<f32>(0.58, 0.64, 0.74);
            let cloud = mix(bright, shade, clamp(lit * 0.85 + density * 0.15, 0.0, 1.0) * (1.0 - 0.5 * edge));
            let fade = smoothstep(0.015, 0.16, direction.y);
            color = mix(color, cloud, density * 0.9 * fade * (1.0 - frame.screen.w));
        }
    }
    return vec4<f32>(color, 1.0);
}
