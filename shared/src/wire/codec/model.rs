//! Adaptive probabilities, and the contexts that select them.

use super::arithmetic::{Coder, Probability};
use super::tile::{Tile, neighbours};

/// Sets of statistics: one for θ or u, one shared by ωx and ωz (or v and w), one for dust.
const KINDS: usize = 3;
/// Number of size classes of the neighbours' residuals.
const SIZES: usize = 6;
/// Longest exp-Golomb prefix: magnitudes up to 2¹⁷ − 1, the largest difference of two differences.
const PREFIX: usize = 17;

#[derive(Default)]
pub(super) struct Model {
    changed: [[Probability; 3]; KINDS],
    predicted: [Probability; KINDS],
    zero: [[[Probability; SIZES]; 2]; KINDS],
    sign: [[Probability; 3]; 2],
    prefix: [[[Probability; PREFIX]; SIZES]; KINDS],
    suffix: [[Probability; PREFIX]; PREFIX],
}

fn kind(plane: usize) -> usize {
    [0, 1, 1, 2][plane.min(3)]
}

impl Model {
    /// Context of a tile's change: how many of the tiles to the left and above have residuals at their shared border.
    pub(super) fn tile_context(&self, plane: usize, tile: &Tile, width: usize, residuals: &[i32]) -> (usize, usize) {
        let left = tile.x.start > 0 && tile.y.clone().any(|y| residuals[y * width + tile.x.start - 1] != 0);
        let above = tile.y.start > 0 && tile.x.clone().any(|x| residuals[(tile.y.start - 1) * width + x] != 0);
        (kind(plane), usize::from(left) + usize::from(above))
    }

    pub(super) fn changed(&mut self, (kind, borders): (usize, usize)) -> &mut Probability {
        &mut self.changed[kind][borders]
    }

    pub(super) fn predicted(&mut self, plane: usize) -> &mut Probability {
        &mut self.predicted[kind(plane)]
    }

    /// Codes the residual of cell `at`, stores it in `residuals` and returns it.
    #[expect(clippy::too_many_arguments, reason = "the context of a cell is its tile's mode and its position")]
    pub(super) fn code_residual(
        &mut self,
        coder: &mut impl Coder,
        plane: usize,
        predicted: bool,
        width: usize,
        at: usize,
        residuals: &mut [i32],
        residual: Option<i32>,
    ) -> i32 {
        let [left, above, above_left] = neighbours(residuals, width, at);
        let size = size_class(2 * (left.abs() + above.abs()) + above_left.abs());
        let kind = kind(plane);
        if coder.code(&mut self.zero[kind][usize::from(predicted)][size], residual.map(|r| r == 0)) {
            residuals[at] = 0;
            return 0;
        }
        let lean = ((left + above).signum() + 1) as usize;
        let negative = coder.code(&mut self.sign[usize::from(predicted)][lean], residual.map(|r| r < 0));
        let magnitude = self.code_magnitude(coder, kind, size, residual.map(|r| r.unsigned_abs()));
        let residual = if negative { -magnitude } else { magnitude };
        residuals[at] = residual;
        residual
    }

    /// Exp-Golomb code of a magnitude of at least 1: the position of its top bit in unary, then the bits below it.
    fn code_magnitude(&mut self, coder: &mut impl Coder, kind: usize, size: usize, magnitude: Option<u32>) -> i32 {
        let top = magnitude.map(|m| m.ilog2() as usize);
        let mut length = 0;
        while length + 1 < PREFIX && coder.code(&mut self.prefix[kind][size][length], top.map(|top| length < top)) {
            length += 1;
        }
        let mut value = 1_u32;
        for place in (0..length).rev() {
            let bit = coder.code(&mut self.suffix[length][place], magnitude.map(|m| (m >> place) & 1 == 1));
            value = (value << 1) | u32::from(bit);
        }
        value as i32
    }
}

fn size_class(sum: i32) -> usize {
    match sum {
        0 => 0,
        1..=2 => 1,
        3..=4 => 2,
        5..=9 => 3,
        10..=24 => 4,
        _ => 5,
    }
}
