// Interpolation between four pixels.

import package::constants::LUMINANCE;

// Colour at a fraction of the way from north-west to south-east between four pixels: linear in the two triangles on both sides of the diagonal that
// changes less, so that an edge is not blurred across itself (data-dependent triangulation; Su & Willis 2004). The fractions are steeper in the middle.
fn between(nw: vec3<f32>, ne: vec3<f32>, sw: vec3<f32>, se: vec3<f32>, way: vec2<f32>) -> vec3<f32> {
    let falls = abs(dot(nw - se, LUMINANCE)) < abs(dot(ne - sw, LUMINANCE));
    let steep = mix(way, way * way * (3.0 - 2.0 * way), 0.5);
    // Mirrored, so that the diagonal runs from the first to the last pixel.
    let f = vec2<f32>(select(1.0 - steep.x, steep.x, falls), steep.y);
    let first = select(ne, nw, falls);
    let beside = select(nw, ne, falls);
    let below = select(se, sw, falls);
    let last = select(sw, se, falls);
    let is_beside = f.x > f.y;
    let corner = select(below, beside, is_beside);
    let near = select(f.y - f.x, f.x - f.y, is_beside);
    let far = min(f.x, f.y);
    return first + near * (corner - first) + far * (last - first);
}
