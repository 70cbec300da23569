//! One V-cycle of geometric multigrid, as a preconditioner.

use super::coloured::{Coloured, Layout, at, set};
use super::kernels;
use super::operator::Operator;
use super::system::{System, below};
use super::transfer::{Lean, Transfer};

/// Axes whose cells are no wider than this many times the narrowest are coarsened, so that coupling is about the same along all of them before long.
const COARSENED_WITHIN: f64 = std::f64::consts::SQRT_2;

/// A hierarchy of grids down to a single cell, in single precision: half the memory to move, and the iteration around it corrects the rounding.
///
/// Red–black Gauss–Seidel before (red, then black) and after (black, then red), so that the cycle is symmetric and positive definite on what the matrix can
/// produce. Only the axes of about the smallest spacing are coarsened (semi-coarsening). The coupling of two coarse cells is the open area between them over
/// the distance of their centres, as on the finest grid, so that a grid without solids is discretised anew and a face half shut by solids lets half through.
#[derive(Clone, Debug)]
pub(super) struct Multigrid {
    /// Finest first.
    levels: Vec<Level>,
}

#[derive(Clone, Debug)]
struct Level {
    operator: Operator<f32>,
    p: Coloured<f32>,
    b: Coloured<f32>,
    r: Coloured<f32>,
    /// To the next coarser level; none on the last.
    transfer: Option<Transfer<f32>>,
    /// Two cells of a colour meet where an odd number of cells wraps.
    seams: bool,
}

impl Multigrid {
    pub(super) fn new(system: &System) -> Self {
        let mut grid = Grid::finest(system);
        let mut levels = vec![];
        loop {
            let coarser = grid.coarsen();
            let (transfer, next) = coarser.unzip();
            levels.push(Level::new(&grid.operator, transfer));
            match next {
                Some(next) => grid = next,
                None => return Self { levels },
            }
        }
    }

    /// One cycle from zero for the residual `scale r`.
    pub(super) fn cycle(&mut self, r: &Coloured<f64>, scale: f64) {
        let finest = &mut self.levels[0];
        let layout = finest.operator.layout;
        for colour in 0..2 {
            layout.for_each_plane(colour, &mut finest.b[colour], |start, b| kernels::narrow(b, &r[colour][start..], scale));
        }
        cycle(&mut self.levels);
    }

    /// What the last cycle came to.
    pub(super) fn correction(&self) -> &Coloured<f32> {
        &self.levels[0].p
    }
}

fn cycle(levels: &mut [Level]) {
    let Some((level, coarser)) = levels.split_first_mut() else { return };
    let Level { operator, p, b, r, transfer, seams } = level;
    if *seams {
        p[1].fill(0.0);
    }
    operator.relax_from_zero(0, p, b);
    operator.relax(1, p, b);
    if let (Some(transfer), Some(next)) = (transfer, coarser.first_mut()) {
        operator.residual(0, p, b, r);
        // The black equations have just been solved, but for those that meet black cells.
        if *seams {
            operator.layout.wrap(0, p);
            operator.residual(1, p, b, r);
        }
        transfer.restrict(r, &mut next.b);
        cycle(coarser);
        transfer.prolong(&coarser[0].p, p);
        (0..2).for_each(|colour| operator.layout.wrap(colour, p));
    }
    operator.relax(1, p, b);
    operator.relax(0, p, b);
}

impl Level {
    fn new(operator: &Operator<f64>, transfer: Option<Transfer<f32>>) -> Self {
        let layout = operator.layout;
        let seams = (0..3).any(|axis| layout.wraps[axis] && layout.cells[axis] % 2 == 1);
        Self { operator: operator.cast(), p: layout.zeros(), b: layout.zeros(), r: layout.zeros(), transfer, seams }
    }
}

/// A level while it is built.
struct Grid {
    operator: Operator<f64>,
    /// Couplings to the open edges across each axis.
    outlets: [Coloured<f64>; 3],
    /// Width (m) of the cells along each axis by padded coordinate; the last may be narrower than the others.
    widths_m: [Vec<f64>; 3],
    /// Spacing (m) a regular grid would have.
    spacing_m: [f64; 3],
    /// Volume (m³) of a cell of the finest grid, which couplings are per.
    unit_m3: f64,
}

impl Grid {
    fn finest(system: &System) -> Self {
        let spacing_m = system.spacing_m;
        let widths_m = [0, 1, 2].map(|axis| vec![spacing_m[axis]; system.cells()[axis] + 2]);
        let unit_m3 = spacing_m.iter().product();
        Self { operator: system.operator.clone(), outlets: system.outlets.clone(), widths_m, spacing_m, unit_m3 }
    }

    /// Distance (m) of the centre of cell `i` from that below, or from the edge of the box.
    fn reach_below_m(&self, axis: usize, i: usize) -> f64 {
        let (widths_m, layout) = (&self.widths_m[axis], &self.operator.layout);
        let below = if i > 1 { widths_m[i - 1] } else if layout.wraps[axis] { widths_m[layout.cells[axis]] } else { 0.0 };
        0.5 * (widths_m[i] + below)
    }

    /// Distance (m) of the centre of cell `i` from that above, or from the edge of the box.
    fn reach_above_m(&self, axis: usize, i: usize) -> f64 {
        let (n, wraps) = (self.operator.layout.cells[axis], self.operator.layout.wraps[axis]);
        if i < n {
            self.reach_below_m(axis, i + 1)
        } else if wraps {
            self.reach_below_m(axis, 1)
        } else {
            0.5 * self.widths_m[axis][i]
        }
    }

    /// The next coarser grid and the way there, unless there is but one cell.
    fn coarsen(&self) -> Option<(Transfer<f32>, Self)> {
        let fine = self.operator.layout;
        let long = |axis: &usize| fine.cells[*axis] > 1;
        let narrowest = (0..3).filter(long).map(|axis| self.spacing_m[axis]).reduce(f64::min)?;
        let factor = [0, 1, 2].map(|axis| if long(&axis) && self.spacing_m[axis] <= COARSENED_WITHIN * narrowest { 2 } else { 1 });
        let coarse = Layout::new([0, 1, 2].map(|axis| fine.cells[axis].div_ceil(factor[axis])), fine.wraps);
        let spacing_m = [0, 1, 2].map(|axis| self.spacing_m[axis] * factor[axis] as f64);
        let parent = |cell: [usize; 3]| [0, 1, 2].map(|axis| cell[axis].div_ceil(factor[axis]));
        let widths_m = [0, 1, 2].map(|axis| {
            let mut widths_m = vec![0.0; coarse.cells[axis] + 2];
            (1..=fine.cells[axis]).for_each(|i| widths_m[i.div_ceil(factor[axis])] += self.widths_m[axis][i]);
            widths_m
        });
        let mut next = Self { operator: self.operator.clone(), outlets: self.outlets.clone(), widths_m, spacing_m, unit_m3: self.unit_m3 };
        next.operator.layout = coarse;

        // Open areas add up; distances grow.
        let mut lower = [0, 1, 2].map(|_| coarse.zeros());
        let mut outlets = [0, 1, 2].map(|_| coarse.zeros());
        for cell in fine.coordinates() {
            let (from, to) = (fine.linear(cell), parent(cell));
            let l = coarse.linear(to);
            for axis in 0..3 {
                let first = factor[axis] == 1 || cell[axis] % 2 == 1;
                if first && below(to, axis, coarse.cells, fine.wraps[axis]).is_some_and(|below| below != to) {
                    let stretch = self.reach_below_m(axis, cell[axis]) / next.reach_below_m(axis, to[axis]);
                    let sum = at(&lower[axis], l) + at(&self.operator.lower[axis], from) * stretch;
                    set(&mut lower[axis], l, sum);
                }
                let stretch = self.widths_m[axis][cell[axis]] / next.widths_m[axis][to[axis]];
                let sum = at(&outlets[axis], l) + at(&self.outlets[axis], from) * stretch;
                set(&mut outlets[axis], l, sum);
            }
        }
        next.operator = Operator::new(coarse, lower, &outlets);
        next.outlets = outlets;
        let leans = (0..3).filter(|&axis| factor[axis] == 2).map(|axis| self.lean(&next, axis)).collect();
        Some((Transfer::new(fine, coarse, leans), next))
    }

    /// Weights of linear interpolation from `coarse` to this grid along one axis.
    fn lean(&self, coarse: &Self, axis: usize) -> Lean<f32> {
        let layout = coarse.operator.layout;
        let mut share = [0, 1].map(|_| vec![0.0; layout.padded_len()]);
        for cell in layout.coordinates() {
            let (l, i) = (layout.linear(cell), cell[axis]);
            let area_m2: f64 = (0..3).filter(|&other| other != axis).map(|other| coarse.widths_m[other][cell[other]]).product();
            // Coupling through a face that is open all over.
            let open = |reach_m: f64| area_m2 / reach_m / self.unit_m3;
            let (below_m, above_m) = (coarse.reach_below_m(axis, i), coarse.reach_above_m(axis, i));
            let outlet = at(&coarse.outlets[axis], l);
            let [mut lower, mut upper] = [l, l + layout.stride[axis]].map(|l| at(&coarse.operator.lower[axis], l));
            if !layout.wraps[axis] {
                // A cell between two open edges cannot tell them apart.
                lower += if i == 1 { outlet } else { 0.0 };
                upper += if i == layout.cells[axis] { outlet } else { 0.0 };
            }
            let children_m = [2 * i - 1, 2 * i].map(|child| if child <= self.operator.layout.cells[axis] { self.widths_m[axis][child] } else { 0.0 });
            share[0][l] = (0.5 * children_m[1] / below_m * (lower / open(below_m)).min(1.0)) as f32;
            share[1][l] = (0.5 * children_m[0] / above_m * (upper / open(above_m)).min(1.0)) as f32;
        }
        Lean { axis, share }
    }
}
