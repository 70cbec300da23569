//! Building a coarser grid from a finer one.

use super::coloured::{Coloured, Layout, at, set};
use super::operator::Operator;
use super::system::{System, below};
use super::transfer::{Lean, Transfer};

/// Semi-coarsening limit: axes with cells up to this many times the narrowest are coarsened, which soon evens out the coupling along them.
const COARSENED_WITHIN: f64 = std::f64::consts::SQRT_2;

/// A grid of the hierarchy during its construction.
pub(super) struct CoarseningGrid {
    pub(super) operator: Operator<f64>,
    /// Couplings to the open edges of each axis.
    pub(super) outlets: [Coloured<f64>; 3],
    axes: [Axis; 3],
    /// Volume (m³) of a cell of the finest grid; couplings are per this volume.
    unit_m3: f64,
}

/// Cells along one axis.
struct Axis {
    /// Width (m) of each cell by padded coordinate; halving an odd number of cells leaves a narrower last one.
    widths_m: Vec<f64>,
    cells: usize,
    wraps: bool,
}

impl Axis {
    /// Distance (m) from the centre of cell `i` to that of the cell below, or to the edge of the box.
    fn reach_below_m(&self, i: usize) -> f64 {
        let below_m = match i {
            1 if self.wraps => self.widths_m[self.cells],
            1 => 0.0,
            _ => self.widths_m[i - 1],
        };
        0.5 * (self.widths_m[i] + below_m)
    }

    /// Distance (m) from the centre of cell `i` to that of the cell above, or to the edge of the box.
    fn reach_above_m(&self, i: usize) -> f64 {
        match i {
            _ if i < self.cells => self.reach_below_m(i + 1),
            _ if self.wraps => self.reach_below_m(1),
            _ => 0.5 * self.widths_m[i],
        }
    }

    /// Merges every `factor` cells into one.
    fn coarsen(&self, factor: usize) -> Self {
        let cells = self.cells.div_ceil(factor);
        let mut widths_m = vec![0.0; cells + 2];
        (1..=self.cells).for_each(|i| widths_m[i.div_ceil(factor)] += self.widths_m[i]);
        Self { widths_m, cells, wraps: self.wraps }
    }
}

impl CoarseningGrid {
    /// The grid of the system itself.
    pub(super) fn finest(system: &System) -> Self {
        let layout = system.operator.layout;
        let axes = [0, 1, 2].map(|axis| Axis {
            widths_m: vec![system.spacing_m[axis]; layout.cells[axis] + 2],
            cells: layout.cells[axis],
            wraps: layout.wraps[axis],
        });
        Self { operator: system.operator.clone(), outlets: system.outlets.clone(), axes, unit_m3: system.spacing_m.iter().product() }
    }

    /// The next coarser grid and the transfer to it; `None` for a single cell.
    pub(super) fn coarsen(&self) -> Option<(Transfer<f32>, Self)> {
        let long = |axis: &usize| self.axes[*axis].cells > 1;
        // The first cell is never the narrower one at the end.
        let narrowest_m = (0..3).filter(long).map(|axis| self.axes[axis].widths_m[1]).reduce(f64::min)?;
        let factor = [0, 1, 2].map(|axis| if long(&axis) && self.axes[axis].widths_m[1] <= COARSENED_WITHIN * narrowest_m { 2 } else { 1 });
        let axes = [0, 1, 2].map(|axis| self.axes[axis].coarsen(factor[axis]));
        let fine = self.operator.layout;
        let layout = Layout::new([0, 1, 2].map(|axis| axes[axis].cells), fine.wraps);

        // Open areas add up; distances grow.
        let mut lower = [0, 1, 2].map(|_| layout.zeros());
        let mut outlets = [0, 1, 2].map(|_| layout.zeros());
        for cell in fine.coordinates() {
            let parent = [0, 1, 2].map(|axis| cell[axis].div_ceil(factor[axis]));
            let (from, to) = (fine.linear(cell), layout.linear(parent));
            for axis in 0..3 {
                let (i, j) = (cell[axis], parent[axis]);
                let outer = factor[axis] == 1 || i % 2 == 1;
                if outer && below(parent, axis, layout.cells, fine.wraps[axis]).is_some_and(|below| below != parent) {
                    let nearness = self.axes[axis].reach_below_m(i) / axes[axis].reach_below_m(j);
                    let sum = at(&lower[axis], to) + nearness * at(&self.operator.lower[axis], from);
                    set(&mut lower[axis], to, sum);
                }
                let nearness = self.axes[axis].widths_m[i] / axes[axis].widths_m[j];
                let sum = at(&outlets[axis], to) + nearness * at(&self.outlets[axis], from);
                set(&mut outlets[axis], to, sum);
            }
        }
        let coarse = Self { operator: Operator::new(layout, lower, &outlets), outlets, axes, unit_m3: self.unit_m3 };
        let leans = (0..3).filter(|&axis| factor[axis] == 2).map(|axis| self.lean(&coarse, axis)).collect();
        Some((Transfer::new(fine, layout, leans), coarse))
    }

    /// Weights of linear interpolation from `coarse` to this grid along one axis.
    fn lean(&self, coarse: &Self, axis: usize) -> Lean<f32> {
        let layout = coarse.operator.layout;
        let (fine_along, along) = (&self.axes[axis], &coarse.axes[axis]);
        let mut fraction = [vec![0.0; layout.padded_len()], vec![0.0; layout.padded_len()]];
        for cell in layout.coordinates() {
            let (l, i) = (layout.linear(cell), cell[axis]);
            let area_m2: f64 = (0..3).filter(|&other| other != axis).map(|other| coarse.axes[other].widths_m[cell[other]]).product();
            let openness = |coupling: f64, reach_m: f64| (coupling * reach_m * self.unit_m3 / area_m2).min(1.0);
            let [mut lower, mut upper] = [l, l + layout.stride[axis]].map(|l| at(&coarse.operator.lower[axis], l));
            // A single cell's two edges count as one.
            if !layout.wraps[axis] {
                let outlet = at(&coarse.outlets[axis], l);
                lower += if i == 1 { outlet } else { 0.0 };
                upper += if i == along.cells { outlet } else { 0.0 };
            }
            let (below_m, above_m) = (along.reach_below_m(i), along.reach_above_m(i));
            // A child's centre is half its sibling's width away from its parent's.
            let [lower_m, upper_m] =
                [2 * i - 1, 2 * i].map(|child| if child <= fine_along.cells { fine_along.widths_m[child] } else { 0.0 });
            fraction[0][l] = (0.5 * upper_m / below_m * openness(lower, below_m)) as f32;
            fraction[1][l] = (0.5 * lower_m / above_m * openness(upper, above_m)) as f32;
        }
        Lean { axis, fraction }
    }
}
