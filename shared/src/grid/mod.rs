//! Shapes and coordinates of the 2-D grid of patches.

use crate::scene::Patches;
use serde::{Deserialize, Serialize};

/// Grid of the bend field's patches: conversion between cells, patches and metres.
///
/// Cell `(i, j)` of a patch covers `[i, i+1) × [j, j+1)` cells from the patch's north-west corner; its value belongs to
/// its centre, `((i + ½)·cell_m, (j + ½)·cell_m)` from that corner.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PatchLayout {
    /// Patches along X and Z.
    pub count: [u32; 2],
    /// Cells along one side of a patch.
    pub cells: u32,
    /// Side of a cell (m).
    pub cell_m: f32,
}

impl From<&Patches> for PatchLayout {
    fn from(patches: &Patches) -> Self {
        Self { count: patches.count, cells: patches.cells, cell_m: patches.cell_m }
    }
}

/// Index of a patch: `x + z · count_x`.
pub type PatchIndex = u32;

impl PatchLayout {
    /// Side of a patch (m).
    pub fn patch_m(&self) -> f32 {
        self.cells as f32 * self.cell_m
    }

    /// Extent of the world along X and Z (m).
    pub fn extent_m(&self) -> [f32; 2] {
        self.count.map(|n| n as f32 * self.patch_m())
    }

    /// Number of patches.
    pub fn patches(&self) -> usize {
        self.count[0] as usize * self.count[1] as usize
    }

    /// Index of patch `(x, z)`; `None` outside the world.
    pub fn index(&self, x: i64, z: i64) -> Option<PatchIndex> {
        let inside = x >= 0 && z >= 0 && x < i64::from(self.count[0]) && z < i64::from(self.count[1]);
        inside.then(|| x as u32 + z as u32 * self.count[0])
    }

    /// Position `(x, z)` of a patch in the grid of patches.
    pub fn place(&self, patch: PatchIndex) -> [u32; 2] {
        [patch % self.count[0], patch / self.count[0]]
    }

    /// North-west corner of a patch (m).
    pub fn corner_m(&self, patch: PatchIndex) -> [f32; 2] {
        self.place(patch).map(|n| n as f32 * self.patch_m())
    }

    /// Centre of a patch (m).
    pub fn center_m(&self, patch: PatchIndex) -> [f32; 2] {
        self.corner_m(patch).map(|m| m + 0.5 * self.patch_m())
    }

    /// The patch that contains the point `(x_m, z_m)`; `None` outside the world.
    pub fn patch_at(&self, x_m: f32, z_m: f32) -> Option<PatchIndex> {
        let side = self.patch_m();
        self.index((x_m / side).floor() as i64, (z_m / side).floor() as i64)
    }

    /// Patches that the rectangle from `low_m` to `high_m` touches, in index order.
    pub fn patches_touching(&self, low_m: [f32; 2], high_m: [f32; 2]) -> impl Iterator<Item = PatchIndex> + use<> {
        let side = self.patch_m();
        let range = |axis: usize| {
            let first = (low_m[axis] / side).floor().max(0.0) as u32;
            let last = (high_m[axis] / side).floor().min(self.count[axis] as f32 - 1.0);
            first..(if last < 0.0 { first } else { last as u32 + 1 })
        };
        let count_x = self.count[0];
        let (columns, rows) = (range(0), range(1));
        rows.flat_map(move |z| columns.clone().map(move |x| x + z * count_x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAYOUT: PatchLayout = PatchLayout { count: [4, 3], cells: 8, cell_m: 0.5 };

    #[test]
    fn index_and_place_are_inverse() {
        for patch in 0..LAYOUT.patches() as u32 {
            let [x, z] = LAYOUT.place(patch);
            assert_eq!(LAYOUT.index(i64::from(x), i64::from(z)), Some(patch));
            let [cx, cz] = LAYOUT.center_m(patch);
            assert_eq!(LAYOUT.patch_at(cx, cz), Some(patch));
        }
        assert_eq!(LAYOUT.index(-1, 0), None);
        assert_eq!(LAYOUT.patch_at(16.0, 1.0), None);
    }

    #[test]
    fn touching_covers_the_rectangle_and_stays_inside() {
        let touched: Vec<_> = LAYOUT.patches_touching([3.0, -5.0], [9.0, 4.5]).collect();
        assert_eq!(touched, [0, 1, 2, 4, 5, 6]);
        assert_eq!(LAYOUT.patches_touching([20.0, 0.0], [30.0, 1.0]).count(), 0);
        assert_eq!(LAYOUT.patches_touching([-9.0, 0.0], [-3.0, 1.0]).count(), 0);
    }
}
