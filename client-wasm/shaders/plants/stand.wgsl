// Plants of the underbrush to be drawn, and their lists.

import package::uniforms::BrushLists;

// A plant to be drawn: root (m) and displayed size; lean of the ground (rad), light and heading; pressure along X and Z (Pa), variant and
// kind of the surrounding grass, and a bit mask of the spheres that it may touch; height (m), hue, distance (m), and its own size.
struct Stand {
    root: vec4<f32>,
    lean: vec4<f32>,
    feels: vec4<f32>,
    about: vec4<f32>,
    // Colour of the surrounding grass as seen from afar, and how much of that shows between the plants that are drawn.
    sward: vec4<f32>,
    // Tint of the grass there; the list that the plant is in.
    tint: vec4<f32>,
    // Normal of the land; the first block of its rows.
    up: vec4<f32>,
    // In-scattered light and transmittance of the air in front of it.
    air: vec4<f32>,
}

@group(1) @binding(15) var<uniform> lists: BrushLists;

// Marks a block of rows that no plant owns.
const NOBODY: u32 = 0xffffffffu;
