//! Random numbers by place, the same on the GPU.

/// Three random numbers for a place and a number: an integer hash (pcg3d; Jarzynski & Olano, Hash Functions for GPU Rendering, JCGT 9(3),
/// 2020), so that server, client and GPU agree to the bit.
///
/// Its twin on the GPU is `hash3` in `common.wgsl`.
pub fn hash3(place: [u32; 3]) -> [u32; 3] {
    let stir = |[mut x, mut y, mut z]: [u32; 3]| {
        x = x.wrapping_add(y.wrapping_mul(z));
        y = y.wrapping_add(z.wrapping_mul(x));
        z = z.wrapping_add(x.wrapping_mul(y));
        [x, y, z]
    };
    let scrambled = place.map(|v| v.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    stir(stir(scrambled).map(|v| v ^ (v >> 16)))
}

/// A seed in half its bits, as [`hash3`] takes it.
pub(crate) fn folded(seed: u64) -> u32 {
    (seed ^ (seed >> 32)) as u32
}
