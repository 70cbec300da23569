// Light of lamps. Twin of shared/src/light/lamp.rs.

import package::constants::LEAST_LAMP_DISTANCE_M;
import package::inputs::frame::frame;
import package::uniforms::Lamp;

struct LampRay {
    // Unit vector towards the lamp.
    toward: vec3<f32>,
    rgb: vec3<f32>,
}

// Twin of `attenuation` in shared/src/light/lamp.rs.
fn attenuation(weights: vec3<f32>, distance_m: f32) -> f32 {
    let d = max(distance_m, LEAST_LAMP_DISTANCE_M);
    return 1.0 / dot(weights, vec3<f32>(1.0, d, d * d));
}

// Light of a lamp at a position: 0 beyond its reach.
fn lamp_ray(lamp: Lamp, p: vec3<f32>) -> LampRay {
    let to = lamp.position_m - p;
    let distance_m = length(to);
    let toward = to / max(distance_m, 1e-3);
    let cone = smoothstep(lamp.edge_cosine, lamp.full_cosine, -dot(toward, lamp.direction));
    let ending = 1.0 - smoothstep(0.7, 1.0, distance_m / lamp.reach_m);
    return LampRay(toward, lamp.rgb * (attenuation(lamp.attenuation, distance_m) * cone * ending));
}

// Whether any lamp is lit. Fixed at pipeline creation, since software drivers execute one iteration even of an empty loop.
override has_lamps: bool = true;

// Number of lamps that may reach a position. It depends on the position so that drivers do not recompile the shader for each value of a
// uniform.
fn lamps_about(p: vec3<f32>) -> u32 {
    return select(0u, frame.lamp_count, has_lamps && distance(p, frame.lights.lit_centre_m) < frame.lights.lit_radius_m);
}

// Light of all lamps on a surface, divided by π. `around` is how far light wraps around it: 0 for solids.
fn lamps_on(p: vec3<f32>, normal: vec3<f32>, around: f32) -> vec3<f32> {
    var light = vec3<f32>(0.0);
    for (var i = 0u; i < lamps_about(p); i++) {
        let ray = lamp_ray(frame.lights.lamps[i], p);
        light += ray.rgb * clamp((dot(normal, ray.toward) + around) / (1.0 + around), 0.0, 1.0);
    }
    return light;
}
