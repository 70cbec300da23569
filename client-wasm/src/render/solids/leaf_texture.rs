//! Texture of the leaves of trees.

use crate::render::inputs::canvas::Canvas;
use crate::render::inputs::random::Random;

/// Side of the texture (px).
pub(crate) const LEAF_PX: u32 = 128;

/// A spray of leaves with mip levels. R is brightness, A coverage.
pub(crate) fn leaves() -> Vec<Vec<u8>> {
    let side = LEAF_PX as usize;
    let mut canvas = Canvas::new([LEAF_PX; 2]);
    let mut random = Random::new(5);
    for _ in 0..110 {
        let (angle, radius) = (random.between(0.0, std::f32::consts::TAU), random.next().sqrt() * 48.0);
        let centre = [64.0 + radius * angle.cos(), 64.0 + radius * angle.sin()];
        let turn = random.between(0.0, std::f32::consts::TAU);
        let (long, wide) = (random.between(7.0, 11.0), random.between(3.0, 4.6));
        let light = random.between(90.0, 230.0);
        for y in -12_i64..=12 {
            for x in -12_i64..=12 {
                let (fx, fy) = (x as f32, y as f32);
                let along = fx * turn.cos() + fy * turn.sin();
                let across = -fx * turn.sin() + fy * turn.cos();
                let taper = 1.0 - (along / long).powi(2);
                if taper > 0.0 && across.abs() < wide * taper {
                    let rib = if across.abs() < 0.5 { 0.85 } else { 1.0 };
                    let px = [(centre[0] + fx) as i64, (centre[1] + fy) as i64];
                    if px.iter().all(|&p| p > 0 && p < side as i64 - 1) {
                        canvas.put(px[0], px[1], [(light * rib) as u8, 0, 0]);
                    }
                }
            }
        }
    }
    canvas.with_mips()
}
