// Sampling of the force field around the camera: what obstacles leave of the wind, and impulses of moving objects.

import package::inputs::frame::clamped;
import package::inputs::wind::resolved_at;
import package::uniforms::ForceFieldFrame;

@group(1) @binding(26) var forces: texture_3d<f32>;
@group(1) @binding(27) var<uniform> force_field: ForceFieldFrame;

// Fractions of the wind's force that arrive along X and Z, and pressure of the impulses along X and Z (Pa), at a height above the land. Outside
// the field nothing is kept away.
fn forces_at(p: vec2<f32>, above_m: f32) -> vec4<f32> {
    let open = vec4<f32>(1.0, 1.0, 0.0, 0.0);
    let at = (p - force_field.corner_m) / force_field.extent_m;
    let inside = 1.0 - smoothstep(0.40, 0.49, max(abs(at.x - 0.5), abs(at.y - 0.5)));
    if inside <= 0.0 {
        return open;
    }
    return mix(open, textureSampleLevel(forces, clamped, vec3<f32>(at, above_m / force_field.height_m), 0.0), inside);
}

// Wind whose dynamic pressure is the fraction `arriving` of that of a wind along each axis. Twin of `sheltered` in
// shared/src/plant/force_field/sources.rs.
fn sheltered(wind: vec2<f32>, arriving: vec2<f32>) -> vec2<f32> {
    let force = arriving * wind * length(wind);
    return force / sqrt(max(length(force), 1e-12));
}

// The solver's wind over the ground (m/s, along X and Z) at a height above `p`, behind obstacles.
fn sheltered_at(p: vec3<f32>, above_m: f32) -> vec2<f32> {
    return sheltered(resolved_at(p, above_m).xz, forces_at(p.xz, above_m).xy);
}
