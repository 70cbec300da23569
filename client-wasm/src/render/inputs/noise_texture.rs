//! Tileable noise.

use crate::render::gpu::mipmaps::{all_mipmaps, box_mipmaps};
use crate::render::inputs::random::Random;

/// Side of the noise texture (px).
pub(crate) const NOISE_PX: u32 = 256;

/// Four channels of tileable fractal value noise, each normalised to 0..1, with all mip levels. R starts at 4 periods, G at 8, B at 16,
/// A at 4 with another seed.
pub(crate) fn noise() -> Vec<Vec<u8>> {
    let side = NOISE_PX as usize;
    let channels = [(4, 1, 5), (8, 2, 4), (16, 3, 3), (4, 4, 5)].map(|(period, seed, octaves)| fractal(side, period, seed, octaves));
    let mut texels = vec![0; side * side * 4];
    for (channel, values) in channels.iter().enumerate() {
        for (i, value) in values.iter().enumerate() {
            texels[i * 4 + channel] = (value * 255.0 + 0.5) as u8;
        }
    }
    box_mipmaps::<4>(texels, [NOISE_PX; 2], all_mipmaps([NOISE_PX; 2]))
}

fn fractal(side: usize, period: usize, seed: u64, octaves: u32) -> Vec<f32> {
    let mut sum = vec![0.0; side * side];
    for octave in 0..octaves {
        let cells = period << octave;
        let mut random = Random::new(seed * 977 + u64::from(octave));
        let lattice: Vec<f32> = (0..cells * cells).map(|_| random.next()).collect();
        let weight = 0.5_f32.powi(octave as i32);
        for z in 0..side {
            for x in 0..side {
                let at = |i: usize| i as f32 * cells as f32 / side as f32;
                let (fx, fz) = (at(x), at(z));
                let (x0, z0) = (fx as usize, fz as usize);
                let smooth = |t: f32| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
                let (tx, tz) = (smooth(fx - x0 as f32), smooth(fz - z0 as f32));
                let value = |i: usize, j: usize| lattice[(j % cells) * cells + i % cells];
                let north = value(x0, z0) * (1.0 - tx) + value(x0 + 1, z0) * tx;
                let south = value(x0, z0 + 1) * (1.0 - tx) + value(x0 + 1, z0 + 1) * tx;
                sum[z * side + x] += weight * (north * (1.0 - tz) + south * tz);
            }
        }
    }
    let (low, high) = sum.iter().fold((f32::MAX, f32::MIN), |(low, high), &v| (low.min(v), high.max(v)));
    sum.iter().map(|v| (v - low) / (high - low)).collect()
}
