//! Where underbrush grows (004 §5.2): sites, soil, and species that spread over both.
//!
//! The plants follow from the scene, its maps and its seed alone. Server and client grow them each for itself and get the same to the bit, on any machine
//! and in wasm: integers decide, and what is not integer takes only `+ − × ÷` and square roots. No list of plants is streamed.
//!
//! - [`sites`]: the lattice of places that a plant may take.
//! - [`nutrients`]: three nutrients in the soil of each site, from a picture or generated.
//! - [`grow`]: the species spread, and compete for room, nutrients and light.
//! - [`Grown`]: the plants, to be found by site and by place.

mod disc;
mod grown;
mod habit;
pub mod nutrients;
pub mod sites;
mod spread;
#[cfg(test)]
mod tests;

pub use grown::{Grown, Plant};
pub use nutrients::{NutrientMap, Soil};
pub use sites::{SITES_LIMIT, Sites};
pub use spread::{Ground, SEEDS, SPECIES_LIMIT, grow};

/// What a random number is for; goes into its hash with the seed, so that no two uses share numbers.
#[derive(Clone, Copy)]
enum Lot {
    Place = 0x51,
    Soil = 0x52,
    Point = 0x53,
    Seed = 0x54,
}

impl Lot {
    /// The scene's seed as this use takes it.
    fn seed(self, seed: u64) -> u32 {
        crate::hash::folded(seed).wrapping_mul(0x9E37_79B1) ^ self as u32
    }
}
