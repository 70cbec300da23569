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
}

/// A force at the cells of the rows between two rows of nodes: `north + rise · share(j)` in row `j`.
pub(super) struct Band {
    north: [Vec<f32>; CHANNELS],
    rise: [Vec<f32>; CHANNELS],
}

impl Band {
    /// No force on rows of `side` cells.
    pub(super) fn zero(side: usize) -> Self {
        let zeros = || std::array::from_fn(|_| vec![0.0; side]);
        Self { north: zeros(), rise: zeros() }
    }

    /// Takes on the force around row `j`, the first below a row of nodes.
    pub(super) fn enter(&mut self, force: &Force, j: usize) {
        let first = j / NODE_CELLS * force.per_side;
        for channel in 0..CHANNELS {
            let (north, south) = force.nodes[channel][first..][..2 * force.per_side].split_at(force.per_side);
            let rows =
                self.north[channel].as_chunks_mut::<NODE_CELLS>().0.iter_mut().zip(self.rise[channel].as_chunks_mut::<NODE_CELLS>().0);
            for ((cells, rise), (north, south)) in rows.zip(north.windows(2).zip(south.windows(2))) {
                for (i, share) in SHARES.into_iter().enumerate() {
                    cells[i] = north[0] + (north[1] - north[0]) * share;
                    rise[i] = south[0] + (south[1] - south[0]) * share - cells[i];
                }
            }
        }
    }

    /// One channel in row `j`.
    #[inline(always)]
    pub(super) fn row(&self, channel: usize, j: usize) -> Added<'_> {
        Added { north: &self.north[channel], rise: &self.rise[channel], share: SHARES[j % NODE_CELLS] }
    }
}

/// What is added to the cells of a row: `north + rise · share`.
#[derive(Clone, Copy)]
pub(super) struct Added<'a> {
    pub(super) north: &'a [f32],
    pub(super) rise: &'a [f32],
    pub(super) share: f32,
}
