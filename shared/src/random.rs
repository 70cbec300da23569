//! Random numbers from a seed, the same on every machine.

use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// Increment of the state: 2⁶⁴ over the golden ratio, made odd.
const GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

/// The generator SplitMix64 (Steele et al. 2014): 64 bits of state, period 2⁶⁴.
#[derive(Clone, Debug)]
pub struct SplitMix64(rand_xoshiro::SplitMix64);

impl SplitMix64 {
    /// A generator that yields the same numbers for the same seed.
    pub fn new(seed: u64) -> Self {
        Self(rand_xoshiro::SplitMix64::seed_from_u64(seed))
    }

    /// The `n`-th number from seed 0, counted from 0, without the ones before it.
    pub fn nth(n: u64) -> u64 {
        Self::new(n.wrapping_mul(GAMMA)).next_u64()
    }

    /// The next 64 bits.
    pub fn next_u64(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// Uniform in [0, 1), with 53 random bits.
    pub fn unit(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_numbers_are_those_of_the_reference_implementation() {
        let mut random = SplitMix64::new(1_234_567);
        assert_eq!([random.next_u64(), random.next_u64()], [6_457_827_717_110_365_317, 3_203_168_211_198_807_973]);
        let mut random = SplitMix64::new(0);
        assert!((0..100).all(|n| random.next_u64() == SplitMix64::nth(n)));
    }
}
