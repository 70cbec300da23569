//! Limits on the size of a scene.

use crate::plant::underbrush::plan;

/// Largest side of the world (m); up to it a coordinate in single precision resolves 1 cm.
pub const EXTENT_LIMIT_M: f32 = 100_000.0;

/// Largest number of bend-field cells that may hold memory at once, about 1 GB.
pub const AWAKE_CELLS_LIMIT: u64 = 1 << 25;

/// Largest number of cells in the wind's box.
pub const WIND_CELLS_LIMIT: u64 = 1 << 21;

/// Largest number of underbrush species in a scene.
pub const SPECIES_LIMIT: usize = 16;

/// Largest number of components of an underbrush species.
pub const COMPONENTS_LIMIT: usize = 16;

/// Largest number of leaves, branches and flowers of one underbrush plant.
pub const PARTS_LIMIT: u64 = plan::COMPONENTS_LIMIT as u64;

/// Largest number of underbrush sites in a world.
pub const SITES_LIMIT: u64 = 1 << 22;
