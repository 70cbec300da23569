// Composites the weighted blended transparency over the picture.

@group(1) @binding(0) var sums: texture_2d<f32>;
@group(1) @binding(1) var left: texture_2d<f32>;

@vertex
fn vs(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 1.0, 1.0);
}

// Weighted mean of the colours, with the total opacity.
@fragment
fn fs(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<i32>(position.xy);
    let sum = textureLoad(sums, pixel, 0);
    return vec4<f32>(sum.rgb / max(sum.a, 1e-5), 1.0 - textureLoad(left, pixel, 0).r);
}
