//! The wind as both sides read it: which place of the solver's box blows where, how it is read between cells and near the ground, and whether there
//! is dust in it.

mod ground;
mod sample;
mod tiling;

pub use ground::share_near_ground;
pub use sample::WindCells;
pub use tiling::{Tap, Tiles, offset_cells};

use crate::scene::Wind;

impl Wind {
    /// Whether anything releases dust, so that the wind carries it over the wire too.
    pub fn has_dust(&self) -> bool {
        self.dust.release_per_s > 0.0
    }
}
