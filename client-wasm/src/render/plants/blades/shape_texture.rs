//! Texture of the shapes of blades.

use crate::render::gpu::constants::BLADE_SHAPES;
use crate::render::gpu::mipmaps::box_mipmaps;

/// Size of the texture (px), with its [`BLADE_SHAPES`] side by side.
pub(super) const BLADE_PX: [u32; 2] = [64 * BLADE_SHAPES, 256];
/// Mip levels, down to 4 px per shape, so that shapes do not bleed into each other.
const BLADE_LEVELS: usize = 5;

/// The five blades of Zhang, Fig. 5 b. R is brightness, A coverage. Tips are at the top.
pub(super) fn blade_shapes() -> Vec<Vec<u8>> {
    let [width, height] = BLADE_PX.map(|px| px as usize);
    let tile = width / BLADE_SHAPES as usize;
    let mut texels = vec![0; width * height * 4];
    for y in 0..height {
        let up = 1.0 - (y as f32 + 0.5) / height as f32;
        for x in 0..width {
            let across = 2.0 * ((x % tile) as f32 + 0.5) / tile as f32 - 1.0;
            if let Some(light) = blade(x / tile, up, across) {
                let at = (y * width + x) * 4;
                texels[at..at + 4].copy_from_slice(&[(light.clamp(0.0, 1.0) * 255.0) as u8, 0, 0, 255]);
            }
        }
    }
    box_mipmaps::<4>(texels, BLADE_PX, BLADE_LEVELS)
}

/// Brightness of a blade at a height (0..1) and a position across (−1..1); `None` beside the blade.
fn blade(shape: usize, up: f32, across: f32) -> Option<f32> {
    let taper = (1.0 - up * up).max(0.0);
    // Centre and half-width of each of its leaves.
    let leaf = |middle: f32, half: f32| {
        let off = (across - middle).abs() / half.max(1e-4);
        (off < 1.0).then(|| 0.92 - 0.22 * off * off - if off < 0.09 { 0.2 } else { 0.0 } + 0.05 * (across * 40.0).sin())
    };
    match shape {
        // A plain lance.
        0 => leaf(0.0, 0.55 * taper * (0.7 + 0.6 * up)),
        // Toothed at its edges.
        1 => leaf(0.0, 0.6 * taper * (0.75 + 0.25 * (1.0 - (up * 14.0).fract()))),
        // A fork of two.
        2 => leaf(-0.32 * up, 0.30 * (1.0 - up).sqrt()).or_else(|| leaf(0.42 * up * up, 0.26 * (1.0 - 0.9 * up))),
        // Three slender ones from one foot.
        3 => leaf(-0.62 * up, 0.15 * (1.0 - up * 1.15).max(0.0).sqrt())
            .or_else(|| leaf(0.05 * up, 0.18 * (1.0 - up).sqrt()))
            .or_else(|| leaf(0.66 * up, 0.15 * (1.0 - up * 1.3).max(0.0).sqrt())),
        // A thin stalk with an ear.
        _ if up < 0.7 => leaf(0.0, 0.12),
        _ => leaf(0.0, 0.34 * (1.0 - ((up - 0.85) / 0.15).powi(2)).max(0.0).sqrt() * (0.6 + 0.4 * (up * 60.0).sin().abs())),
    }
}
