//! Where the puffs of dust belong.

use crate::render::gpu::constants::{DUSTY_CELLS, FULL_PUFFS_DUST};

/// Cells of the wind domain, each as often as puffs belong there: in proportion to the concentration of dust up to [`FULL_PUFFS_DUST`].
#[derive(Clone, Debug, Default)]
pub(crate) struct DustyCells {
    /// Indices of cells, in ascending order; [`DUSTY_CELLS`] of them, or none in clear air.
    pub(crate) cells: Vec<u32>,
    /// Volume that would hold them all at [`FULL_PUFFS_DUST`] (m³).
    pub(crate) volume_m3: f32,
}

impl DustyCells {
    /// Draws cells by systematic resampling (Carpenter, Clifford & Fearnhead 1999, without a random start): one pass, and the number of times that a cell
    /// is drawn differs from its expectation by less than 1.
    pub(crate) fn update(&mut self, concentrations: impl Iterator<Item = f32> + Clone, cell_m3: f32) {
        let weights = concentrations.map(|dust| f64::from((dust / FULL_PUFFS_DUST).clamp(0.0, 1.0)));
        let total: f64 = weights.clone().sum();
        self.volume_m3 = total as f32 * cell_m3;
        self.cells.clear();
        if total == 0.0 {
            return;
        }
        let (step, mut sum) = (total / f64::from(DUSTY_CELLS), 0.0);
        for (cell, weight) in (0..).zip(weights) {
            sum += weight;
            while self.cells.len() < DUSTY_CELLS as usize && (self.cells.len() as f64 + 0.5) * step < sum {
                self.cells.push(cell);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_drawn_in_proportion_to_their_dust() {
        let dust: Vec<f32> = (0..1000).map(|cell| ((cell % 37) as f32 - 20.0) * 0.1).collect();
        let mut drawn = DustyCells::default();
        drawn.update(dust.iter().copied(), 8.0);
        let weight = |dust: f32| (dust / FULL_PUFFS_DUST).clamp(0.0, 1.0);
        let total: f32 = dust.iter().map(|dust| weight(*dust)).sum();
        assert_eq!(drawn.cells.len(), DUSTY_CELLS as usize);
        assert!((drawn.volume_m3 / (8.0 * total) - 1.0).abs() < 1e-5, "{}", drawn.volume_m3);
        for (cell, dust) in (0..).zip(dust) {
            let count = drawn.cells.iter().filter(|drawn| **drawn == cell).count() as f32;
            let expected = weight(dust) / total * DUSTY_CELLS as f32;
            assert!((count - expected).abs() < 1.0 && (dust > 0.0 || count == 0.0), "cell {cell} {count} times instead of {expected}");
        }
    }

    #[test]
    fn clear_air_has_no_dusty_cells() {
        let mut drawn = DustyCells::default();
        drawn.update([1.0].into_iter(), 8.0);
        assert_eq!(drawn.cells, vec![0; DUSTY_CELLS as usize]);
        drawn.update([0.0, -1.0].into_iter(), 8.0);
        assert!(drawn.cells.is_empty() && drawn.volume_m3 == 0.0);
    }
}
