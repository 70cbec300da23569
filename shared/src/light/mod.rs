//! Light: where the sun stands, what the air does to its light, lamps, and how grass is lit.
//!
//! Light is photometric: illuminance in lux and luminance in cd/m², each as linear RGB, where the sun above the air is white.
//! What the shaders compute too has its twin in `light.wgsl`.

pub mod air;
pub mod exposure;
pub mod grass;
pub mod lamp;
pub mod sky;
pub mod sun;

/// Linear red, green and blue.
pub type Rgb = [f32; 3];

/// Share of each of linear red, green and blue in luminance (Rec. 709).
pub const LUMINANCE: Rgb = [0.2126, 0.7152, 0.0722];

/// Luminance of a colour, in the colour's own unit.
pub fn luminance(rgb: Rgb) -> f32 {
    (0..3).map(|i| rgb[i] * LUMINANCE[i]).sum()
}
