//! Hashes of integer coordinates as random numbers, the same on the GPU.

/// Three random numbers for integer coordinates: the hash pcg3d (Jarzynski & Olano 2020), so that server, client and GPU agree to the bit.
///
/// Its twin on the GPU is `hash3` in `inputs/random.wgsl`.
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

/// A 64-bit seed folded into 32 bits, as [`hash3`] takes it.
pub(crate) fn folded(seed: u64) -> u32 {
    (seed ^ (seed >> 32)) as u32
}
