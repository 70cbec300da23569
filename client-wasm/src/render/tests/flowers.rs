//! Flowers as squares with textures show as much of their colours as those with petals.

use super::*;
use prairie_core::scene::FlowerShape;

const SIZE_PX: [u32; 2] = [320, 240];

/// Fraction of the pixels that are redder or bluer than green, in a picture of a lawn with flowers from above, at `pitch_rad`.
fn colourful(gpu: &Gpu, flowers_per_m2: f32, flower_shape: FlowerShape, pitch_rad: f32) -> f64 {
    let mut mirror = meadow_of(
        |scene| {
            (scene.plants.flowers_per_m2, scene.plants.flower_shape) = (flowers_per_m2, flower_shape);
            scene.wind.mean_m_per_s = [0.0; 2];
        },
        &[255; 16 * 16],
    );
    let mut picture = OffscreenRenderer::new(gpu, SIZE_PX, Quality::Low);
    let camera = Camera { eye_m: Vec3::new(32.0, 2.2, 32.0), pitch_rad, ..Camera::default() };
    picture.draw(&mut mirror, &camera, 0.0, 0.0);
    let pixels = picture.rgba();
    let is_flower = |rgba: &[u8]| rgba[0].max(rgba[2]) > rgba[1];
    pixels.chunks_exact(4).filter(|rgba| is_flower(rgba)).count() as f64 / (pixels.len() / 4) as f64
}

#[test]
fn squares_with_textures_show_as_much_colour_as_petals() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    for pitch_rad in [-1.3, -0.7] {
        let [bare, petals, squares] = [(0.0, FlowerShape::Modelled), (20.0, FlowerShape::Modelled), (20.0, FlowerShape::Textured)]
            .map(|(flowers_per_m2, shape)| colourful(&gpu, flowers_per_m2, shape, pitch_rad));
        println!("at {pitch_rad} rad: {bare:.4} without flowers, {petals:.4} with petals, {squares:.4} with squares");
        assert!(petals - bare > 0.005, "the measure sees no flowers: {bare} and {petals}");
        assert!(
            (0.5..2.0).contains(&((squares - bare) / (petals - bare))),
            "{bare} without flowers, {petals} with petals, {squares} with squares"
        );
    }
}
