//! Sampling of the wind on server and client: mapping from the world to the solver's box, trilinear interpolation between cells, gusts finer than the cells, and
//! the profile near the ground. [`WindField`] joins them.

mod field;
mod ground;
mod sample;
mod tiling;
pub mod turbulence;

pub use field::WindField;
pub use ground::{FREE_WIND_M, LEAST_WIND_HEIGHT, near_ground_fraction};
pub use sample::CellGrid;
pub use tiling::{Tap, WindTiles, offset_cells};
pub use turbulence::{Gusts, Turbulence};

use crate::scene::Wind;

impl Wind {
    /// Whether the scene releases dust, which is then part of every wind frame on the wire.
    pub fn has_dust(&self) -> bool {
        self.dust.release_per_s > 0.0
    }
}
