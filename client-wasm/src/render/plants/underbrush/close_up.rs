//! Plants close up (Endo et al. 2003, §7): curves through the rows of their ribbons, and kinds of veins. `near_leaf.wgsl` draws them.

use crate::render::gpu::constants::{CURVE_PARTS, FIRST_ROW, LAST_ROW, PARALLEL, PINNATE, STREAKED};
use prairie_core::scene::{Component, ComponentKind};

/// Length over width from which the veins of a leaf are parallel, as those of grass.
const SLENDER: f32 = 14.0;
/// Distance between parallel veins of a leaf 1 cm wide (m); it grows with the square root of the width.
const PARALLEL_M: f32 = 0.0017;
/// Distance between side veins over the width of the leaf.
const PINNATE_WIDTHS: f32 = 0.34;

/// Properties of row `row` of the `rows` of a ribbon: whether it is the first or last, the kind and number of veins, and the fraction of the length, as
/// in `Row` of `ribbons.wgsl`.
pub(super) fn close_up(component: &Component, is_petal: bool, row: usize, rows: usize) -> u32 {
    let is_last = row + 1 == rows;
    let ends = (u32::from(row == 0) * FIRST_ROW) | (u32::from(is_last) * LAST_ROW);
    let [kind, count] = match component.kind {
        _ if is_petal => [STREAKED, 3],
        ComponentKind::Leaf => veins(component.length_m, component.width_m),
        ComponentKind::Branch | ComponentKind::Flower => [0, 0],
    };
    let along = (row as f32 / (rows - 1).max(1) as f32 * f32::from(u16::MAX)).round() as u32;
    ends | (kind << 2) | (count << 4) | (along << 16)
}

/// Kind of the veins of a leaf, and their number: along it, or on each side if they are parallel.
fn veins(length_m: f32, width_m: f32) -> [u32; 2] {
    if length_m > SLENDER * width_m {
        let spacing_m = PARALLEL_M * (width_m / 0.01).sqrt();
        return [PARALLEL, ((0.5 * width_m / spacing_m).round() as u32).clamp(2, 15)];
    }
    [PINNATE, ((length_m / (PINNATE_WIDTHS * width_m)).round() as u32).clamp(3, 15)]
}

/// Indices of this number of plants with ribbons of these numbers of rows: two vertices for each row and for each point between rows.
pub(super) fn curve_indices(ribbons: &[u32], plants: u32) -> Vec<u32> {
    let mut indices = Vec::new();
    let mut first_row = 0;
    for _ in 0..plants {
        for &rows in ribbons {
            let quads = (0..(rows - 1) * CURVE_PARTS).map(|part| 2 * (first_row * CURVE_PARTS + part));
            indices.extend(quads.flat_map(|a| [a, a + 1, a + 2, a + 2, a + 1, a + 3]));
            first_row += rows;
        }
    }
    indices
}
