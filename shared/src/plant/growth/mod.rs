//! Growth of underbrush (Endo et al. 2003, §5.2): sites, soil, and species that spread over both.
//!
//! The plants follow from the scene, its maps and its seed alone. Server and client grow them independently and get the same bits, on any machine and
//! in wasm: decisions use integers, and real numbers only `+ − × ÷` and square roots. No list of plants is streamed.
//!
//! - [`sites`]: the lattice of plant positions.
//! - [`nutrients`]: three nutrients in the soil of each site, from a picture or generated.
//! - [`grow`]: the species spread, and compete for room, nutrients and light.
//! - [`Grown`]: the plants, with queries by site and by position.

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
pub use spread::{Permission, SEEDS, SPECIES_LIMIT, grow};

/// Purpose of a random number, hashed with the seed, so that no two purposes share numbers.
#[derive(Clone, Copy)]
enum Lot {
    Place = 0x51,
    Soil = 0x52,
    Point = 0x53,
    Seed = 0x54,
}

impl Lot {
    /// The scene's seed for this purpose.
    fn seed(self, seed: u64) -> u32 {
        crate::hash::folded(seed).wrapping_mul(0x9E37_79B1) ^ self as u32
    }
}
