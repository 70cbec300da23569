//! A smooth force on the cells of a patch, known at nodes.

use super::patch::CHANNELS;

/// Cells between two nodes; a patch's side is a multiple of it.
pub const NODE_CELLS: usize = 8;

/// What is added to each channel of each cell in one sub-step: bilinear between nodes that lie [`NODE_CELLS`] cells apart, the
/// first and the last at the patch's edges. Row-major from the north-west, `(side / NODE_CELLS + 1)²` nodes a channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Force {
    /// Nodes along one side.
    pub per_side: usize,
    /// Values at the nodes: θ (rad), ωx, ωz (rad/s).
    pub nodes: [Vec<f32>; CHANNELS],
}

/// Where the centres of cells lie between two nodes.
const SHARES: [f32; NODE_CELLS] = [0.0625, 0.1875, 0.3125, 0.4375, 0.5625, 0.6875, 0.8125, 0.9375];

impl Force {
    /// No force on a patch of `side × side` cells.
    pub fn zero(side: usize) -> Self {
        let per_side = side / NODE_CELLS + 1;
        Self { per_side, nodes: std::array::from_fn(|_| vec![0.0; per_side * per_side]) }
    }

    /// Adds one channel's values at the cells of row `j` to them.
    #[inline(never)]
    pub(super) fn add_row(&self, channel: usize, j: usize, row: &mut [f32]) {
        let share = SHARES[j % NODE_CELLS];
        let (north, south) = self.nodes[channel][j / NODE_CELLS * self.per_side..][..2 * self.per_side].split_at(self.per_side);
        let at = |i: usize| north[i] + (south[i] - north[i]) * share;
        let mut west = at(0);
        for (i, cells) in row.as_chunks_mut::<NODE_CELLS>().0.iter_mut().enumerate() {
            let east = at(i + 1);
            let slope = east - west;
            for i in 0..NODE_CELLS {
                cells[i] += west + slope * SHARES[i];
            }
            west = east;
        }
    }
}
