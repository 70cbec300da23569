//! Extent of the world, in patches of cells.

use serde::{Deserialize, Serialize};

/// Division of the world into square patches of square cells (Chen & Johan §3: `m_p × n_p` patches of `m_g × n_g` cells).
///
/// A cell holds one cluster of grass; a patch is the unit of simulation, sleep and streaming.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Patches {
    /// Patches along X and Z. Default 16 × 16 (Zhang §5.1), allowed 1..=2048 each, and a world of at most
    /// 100 km a side.
    pub count: [u32; 2],
    /// Cells along one side of a patch. Default 64, allowed 8..=256, a multiple of 8.
    pub cells: u32,
    /// Side of a cell (m). Default 0.25, allowed 0.05..=10.
    pub cell_m: f32,
    /// Largest number of patches that hold field memory at once; the patch farthest from any camera is freed first. Default 225 (Chen & Johan §4.2),
    /// allowed 9..=4096, and awake_limit × cells² at most 33554432 (about 1 GB).
    pub awake_limit: u32,
}

impl Default for Patches {
    fn default() -> Self {
        Self { count: [16, 16], cells: 64, cell_m: 0.25, awake_limit: 225 }
    }
}

impl Patches {
    /// Side of a patch (m).
    pub fn patch_m(&self) -> f32 {
        self.cells as f32 * self.cell_m
    }

    /// Extent of the world along X and Z (m).
    pub fn extent_m(&self) -> [f32; 2] {
        self.count.map(|n| n as f32 * self.patch_m())
    }
}
