// Frustum culling.

import package::inputs::frame::frame;

// Whether a sphere (m) may be in view.
fn is_seen(centre: vec3<f32>, radius: f32) -> bool {
    let m = transpose(frame.projection_from_world);
    let c = vec4<f32>(centre, 1.0);
    let left = m[3] + m[0];
    let right = m[3] - m[0];
    let low = m[3] + m[1];
    let high = m[3] - m[1];
    return dot(left, c) > -radius * length(left.xyz) && dot(right, c) > -radius * length(right.xyz)
        && dot(low, c) > -radius * length(low.xyz) && dot(high, c) > -radius * length(high.xyz) && dot(m[3], c) > -radius;
}

// Whether a box (m) may be in view.
fn is_box_seen(low: vec3<f32>, high: vec3<f32>) -> bool {
    let m = transpose(frame.projection_from_world);
    let planes = array<vec4<f32>, 5>(m[3] + m[0], m[3] - m[0], m[3] + m[1], m[3] - m[1], m[3]);
    for (var i = 0; i < 5; i++) {
        let plane = planes[i];
        let farthest = select(low, high, plane.xyz >= vec3<f32>(0.0));
        if dot(plane.xyz, farthest) + plane.w < 0.0 {
            return false;
        }
    }
    return true;
}
