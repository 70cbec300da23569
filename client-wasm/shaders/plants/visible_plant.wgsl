// Plants of the underbrush to be drawn, and their lists.

import package::constants::VARIANTS;
import package::uniforms::BrushLists;

// A plant to be drawn.
struct VisiblePlant {
    // Root (m).
    root_m: vec3<f32>,
    // Displayed size relative to the species: smaller where plants end, larger where they thin out.
    shown_size: f32,
    // Lean of the bend field at its root (rad, X and Z).
    lean_rad: vec2<f32>,
    // Fraction of unshadowed sunlight.
    sunlight: f32,
    // Heading (rad).
    heading_rad: f32,
    // Pressure along X and Z (Pa).
    pressure_pa: vec2<f32>,
    // Variant, those of broken plants after those of upright ones, plus 2 · `VARIANTS` times the kind of the surrounding grass.
    variant_and_kind: u32,
    // Bit mask of the interaction spheres that it may touch.
    spheres: u32,
    // Height (m).
    height_m: f32,
    // Random number 0..1 for its hue.
    hue: f32,
    // Distance from the eye (m).
    distance_m: f32,
    // Its own size relative to the species.
    size: f32,
    // Colour of the surrounding grass as seen from afar.
    grass_rgb: vec3<f32>,
    // Fraction of that colour that shows between the drawn plants.
    grass_fraction: f32,
    // Tint of the surrounding grass.
    tint: vec3<f32>,
    // Number of its list, and in the highest byte its closeness: 0 drawn in straight sections, 255 as curves with veins.
    list: u32,
    // Normal of the land.
    normal: vec3<f32>,
    // First block of its rows.
    first_block: u32,
    // In-scattered light and transmittance of the air in front of it.
    air: vec4<f32>,
}

@group(1) @binding(15) var<uniform> lists: BrushLists;

// Owner of a block of rows that no plant has claimed.
const FREE_BLOCK: u32 = 0xffffffffu;

fn variant_of(plant: VisiblePlant) -> u32 {
    return plant.variant_and_kind % (2u * VARIANTS);
}

fn list_of(plant: VisiblePlant) -> u32 {
    return plant.list & 0xffffffu;
}

fn closeness_of(plant: VisiblePlant) -> u32 {
    return plant.list >> 24u;
}

// Kind of the surrounding grass.
fn kind_around(plant: VisiblePlant) -> u32 {
    return plant.variant_and_kind / (2u * VARIANTS);
}
