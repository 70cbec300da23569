//! Light: position of the sun, atmosphere, lamps, and shading of grass.
//!
//! Light is photometric: illuminance in lux and luminance in cd/m², each as linear RGB, in which the sun above the atmosphere is white. Functions
//! that are also needed on the GPU have twins in `land_and_sky/grass_light.wgsl`, `land_and_sky/sky_light.wgsl`, `inputs/lamps.wgsl` and `inputs/sward_shade.wgsl`.

pub mod air;
pub mod exposure;
pub mod grass;
pub mod lamp;
pub mod shade;
pub mod sky;
pub mod snow;
pub mod sun;

/// Linear red, green and blue.
pub type Rgb = [f32; 3];

/// Weights of linear red, green and blue in luminance (Rec. 709).
pub const LUMINANCE: Rgb = [0.2126, 0.7152, 0.0722];

/// Luminance of a colour, in the colour's own unit.
pub fn luminance(rgb: Rgb) -> f32 {
    (0..3).map(|i| rgb[i] * LUMINANCE[i]).sum()
}
