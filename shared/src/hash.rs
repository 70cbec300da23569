//! Hashes of integer coordinates as random numbers, the same on the GPU.

/// Multiplier of the linear congruential step of [`hash3`].
pub const HASH_MULTIPLIER: u32 = 1_664_525;
/// Increment of that step.
pub const HASH_INCREMENT: u32 = 1_013_904_223;

/// Number of distinct values of [`unit()`]: 2²⁴, the precision of an `f32`.
pub const UNIT_STEPS: f32 = 16_777_216.0;

/// Random bits as a number in 0..1, 1 excluded; uses the upper 24 bits.
pub fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 / UNIT_STEPS
}

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
    let scrambled = place.map(|v| v.wrapping_mul(HASH_MULTIPLIER).wrapping_add(HASH_INCREMENT));
    stir(stir(scrambled).map(|v| v ^ (v >> 16)))
}

/// A 64-bit seed folded into 32 bits, as [`hash3`] takes it.
pub(crate) fn folded(seed: u64) -> u32 {
    (seed ^ (seed >> 32)) as u32
}
