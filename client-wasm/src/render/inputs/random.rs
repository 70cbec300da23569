//! Random numbers that are the same on every machine.

use prairie_core::hash::{hash3, unit};
use prairie_core::random::SplitMix64;

/// Generator of random numbers in 0..1 from a seed, the same on every machine.
pub(crate) struct Random(SplitMix64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(SplitMix64::new(seed))
    }

    pub(crate) fn next(&mut self) -> f32 {
        unit((self.0.next_u64() >> 32) as u32)
    }

    pub(crate) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.next()
    }
}

/// Three random numbers in 0..1 for a grid cell and a number; same as `random3` in WGSL.
pub(crate) fn random3(place: [i32; 2], number: u32) -> [f32; 3] {
    hash3([place[0] as u32, place[1] as u32, number]).map(unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn random_numbers_fill_their_range() {
        let mean = (0..1000).map(|n| random3([3, -7], n)[0]).sum::<f32>() / 1000.0;
        assert!((mean - 0.5).abs() < 0.05, "{mean}");
    }
}
