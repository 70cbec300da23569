// Functions of vectors and angles.

import package::constants::{ARC_COSINE, TAU};

// Component of a vector perpendicular to a unit vector.
fn square(v: vec3<f32>, direction: vec3<f32>) -> vec3<f32> {
    return v - direction * dot(v, direction);
}

fn unit_or(v: vec3<f32>, other: vec3<f32>) -> vec3<f32> {
    let size = length(v);
    return select(other, v / max(size, 1e-30), size > 1e-30);
}

// Angle (rad) of a cosine, to 7e-5: Abramowitz & Stegun 4.4.45. Twin of `acos` in shared/src/plant/underbrush/posture.rs.
fn arc_cosine(cosine: f32) -> f32 {
    let size = abs(cosine);
    let angle = sqrt(max(1.0 - size, 0.0)) * (ARC_COSINE[0] + size * (ARC_COSINE[1] + size * (ARC_COSINE[2] + size * ARC_COSINE[3])));
    return select(angle, 0.5 * TAU - angle, cosine < 0.0);
}
