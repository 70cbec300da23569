// Uniform block and samplers of the frame, shared by all passes.

import package::uniforms::Frame;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(7) var repeated: sampler;
@group(0) @binding(8) var clamped: sampler;

// Zero that the compiler cannot predict: some drivers recompile a shader for every draw if one of its branches depends on uniforms alone.
fn runtime_zero(p: f32) -> f32 {
    return min(abs(p), 0.0);
}
