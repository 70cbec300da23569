//! Texture of the clumps.

use crate::render::inputs::canvas::Canvas;
use crate::render::inputs::random::Random;

/// Size of the texture (px).
pub(crate) const TUFT_PX: [u32; 2] = [1024, 256];

/// Tufts that repeat sideways, with mip levels that preserve coverage. Channels: height along the plant, hue, fraction of petals, coverage.
pub(crate) fn tufts() -> Vec<Vec<u8>> {
    let [width, height] = TUFT_PX.map(|px| px as usize);
    let mut canvas = Canvas::new(TUFT_PX);
    let mut random = Random::new(71);
    for i in 0..430 {
        let back = i < 210;
        let foot = random.between(0.0, width as f32);
        let tall = height as f32 * if back { random.between(0.45, 0.80) } else { random.between(0.42, 0.98) };
        let lean = random.between(-0.42, 0.42) * tall * random.next().sqrt();
        let wide = random.between(2.2, 4.2);
        canvas.blade(foot, tall, lean, wide, random.next(), if back { 0.82 } else { 1.0 });
    }
    for _ in 0..26 {
        let foot = random.between(0.0, width as f32);
        let tall = height as f32 * random.between(0.55, 0.85);
        canvas.blade(foot, tall, random.between(-8.0, 8.0), 1.6, 0.2, 0.9);
        canvas.dot(foot, tall, random.between(3.5, 5.5), random.next());
    }
    canvas.with_mips()
}
