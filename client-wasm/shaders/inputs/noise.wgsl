// Noise texture, four channels of 0..1.

import package::inputs::frame::repeated;

@group(0) @binding(6) var noises: texture_2d<f32>;

fn noise(uv: vec2<f32>) -> vec4<f32> {
    return textureSampleLevel(noises, repeated, uv, 0.0);
}

// Noise in the mip level whose texels are as large as a pixel, `span` in texture coordinates.
fn noise_over(uv: vec2<f32>, span: f32) -> vec4<f32> {
    return textureSampleLevel(noises, repeated, uv, log2(max(span * f32(textureDimensions(noises).x), 1.0)));
}
