// Grass in the natural wind where no camera is near: one patch that repeats (Chen & Johan, section 4.2).

import package::inputs::frame::{frame, runtime_zero, repeated};

// Leans (rad) of the patch.
@group(0) @binding(14) var repeated_leans: texture_2d<f32>;
// Weights of the grass near cameras at the corners of the bend field's patches, around the camera: one more along each side than patches.
@group(0) @binding(15) var near_weights: texture_2d<f32>;

// Lean (rad) of the repeated patch at a position, less where cameras are near. `level` is a mip level of the bend atlas, which has `atlas_px` texels along
// each side and counts by `fraction`.
fn repeated_lean(p: vec2<f32>, level: f32, atlas_px: u32, fraction: f32) -> vec2<f32> {
    if frame.repeated_per_m <= runtime_zero(p.x) {
        return vec2<f32>(0.0);
    }
    let corners = f32(textureDimensions(near_weights).x);
    let patch_m = frame.bend_window_m / (corners - 1.0);
    let near = textureSampleLevel(near_weights, repeated, (p / patch_m + 0.5) / corners, 0.0).x;
    // Texels per metre, relative to the atlas.
    let fineness = f32(textureDimensions(repeated_leans).x) * frame.repeated_per_m * frame.bend_window_m / f32(atlas_px);
    let lean = textureSampleLevel(repeated_leans, repeated, p * frame.repeated_per_m, level + log2(fineness)).xy;
    return lean * (1.0 - near * fraction);
}
