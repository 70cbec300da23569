// Shadows of clouds on the ground.

import package::inputs::frame::frame;
import package::inputs::noise::noise;

// Fraction of sunlight below the clouds, as soft shadows that drift over the land.
fn cloud_light(p: vec2<f32>) -> f32 {
    let at = (p + frame.cloud_offset_m * 0.5) / 620.0;
    let n = noise(at).r * 0.65 + noise(at * 2.7).a * 0.35;
    return 1.0 - 0.62 * smoothstep(0.47, 0.66, n);
}
