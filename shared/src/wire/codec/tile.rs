//! Tiles of a grid, and the prediction of a cell from its neighbours.

use std::ops::Range;

/// Side of a tile (cells), each with its own choice of a prediction. Part of the format; the tiles of activity in [`bend`](crate::bend) are others.
const CODED_TILE: usize = 8;

/// Rectangle of cells, clipped to the grid.
pub(super) struct Tile {
    pub(super) x: Range<usize>,
    pub(super) y: Range<usize>,
}

impl Tile {
    /// Indices of the tile's cells in a plane of rows of `width`, row by row.
    pub(super) fn cells(&self, width: usize) -> impl Iterator<Item = usize> + use<> {
        let columns = self.x.clone();
        self.y.clone().flat_map(move |y| columns.clone().map(move |x| y * width + x))
    }
}

/// Tiles of a plane, row by row.
pub(super) fn tiles(width: usize, rows: usize) -> impl Iterator<Item = Tile> {
    (0..rows).step_by(CODED_TILE).flat_map(move |y| {
        (0..width).step_by(CODED_TILE).map(move |x| Tile { x: x..(x + CODED_TILE).min(width), y: y..(y + CODED_TILE).min(rows) })
    })
}

/// Values to the left, above, and above left of a cell; zero outside the plane.
pub(super) fn neighbours(values: &[i32], width: usize, at: usize) -> [i32; 3] {
    let left_inside = !at.is_multiple_of(width);
    let left = if left_inside { values[at - 1] } else { 0 };
    let above = if at >= width { values[at - width] } else { 0 };
    let above_left = if left_inside && at >= width { values[at - width - 1] } else { 0 };
    [left, above, above_left]
}

/// Median edge detector: predicts a cell from its three neighbours (Weinberger et al. 2000).
pub(super) fn median_edge(values: &[i32], width: usize, at: usize) -> i32 {
    let [left, above, above_left] = neighbours(values, width, at);
    let (low, high) = if left < above { (left, above) } else { (above, left) };
    if above_left >= high {
        low
    } else if above_left <= low {
        high
    } else {
        left + above - above_left
    }
}

/// Whether the prediction leaves smaller residuals in the tile than no prediction.
pub(super) fn predicts_better(tile: &Tile, width: usize, differences: &[i32]) -> bool {
    let (mut plain, mut predicted) = (0_i64, 0_i64);
    for at in tile.cells(width) {
        plain += i64::from(differences[at].abs());
        predicted += i64::from((differences[at] - median_edge(differences, width, at)).abs());
    }
    predicted < plain
}
