//! The wind of a scene.

use serde::{Deserialize, Serialize};

/// What happens at a pair of opposite faces of the wind's box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WindBoundary {
    /// What leaves through one face enters through the other.
    Wrap,
    /// No flow through the face (000 §2.3.7).
    Wall,
}

/// The wind solver's box and what drives it. The box repeats over the world along axes that wrap; its floor follows the
/// terrain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Wind {
    /// Cells along X, Y and Z. Default 32 × 8 × 32, allowed 2..=256 each and 2097152 in all.
    pub cells: [u32; 3],
    /// Side of a cell along X, Y and Z (m). Default 8 × 2 × 8, allowed 0.1..=1000.
    pub spacing_m: [f32; 3],
    /// Boundary along X and Z, `wrap` or `wall`; walls must stand outside the world. Default `wrap`. Along Y the box has a
    /// floor and a lid.
    pub sides: WindBoundary,
    /// Prevailing wind along X and Z at the height of the lowest cells' tops ×5 (m/s). Default (4, 2.5), allowed
    /// −40..=40 each and a length of at most 40; with walls (0, 0).
    pub mean_m_per_s: [f32; 2],
    /// Kinematic (eddy) viscosity ν (m²/s). Default 0.2, allowed 0..=100.
    pub viscosity_m2_per_s: f32,
    /// Number of random source cells that blow at any moment (000 §2.3.1). Default 24, allowed 0..=1000 and
    /// at most the box's cells.
    pub sources: u32,
    /// Greatest speed that a source gives over its life (m/s). Default 14, allowed 0..=40.
    pub source_m_per_s: f32,
    /// Rate at which the mean flow returns to the prevailing wind (1/s). Default 0.2, allowed 0..=10.
    pub mean_rate_per_s: f32,
}

impl Default for Wind {
    fn default() -> Self {
        Self {
            cells: [32, 8, 32],
            spacing_m: [8.0, 2.0, 8.0],
            sides: WindBoundary::Wrap,
            mean_m_per_s: [4.0, 2.5],
            viscosity_m2_per_s: 0.2,
            sources: 24,
            source_m_per_s: 14.0,
            mean_rate_per_s: 0.2,
        }
    }
}
