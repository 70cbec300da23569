//! One V-cycle of geometric multigrid, as a preconditioner.

use super::coarsen::CoarseningGrid;
use super::coloured::Coloured;
use super::islands::Islands;
use super::kernels;
use super::operator::Operator;
use super::system::System;
use super::transfer::Transfer;

/// Pre- and post-smoothing sweeps, without and with solids: a coarse cell can stand for many shapes of solids.
const SWEEPS: [usize; 2] = [1, 2];

/// A hierarchy of grids down to a single cell, in single precision: half the memory traffic, and the outer iteration corrects the rounding.
///
/// Smoothing is red–black Gauss–Seidel, red then black before the coarser grid and black then red after it, which makes the cycle symmetric and
/// positive definite on the range of the matrix. Only the axes of about the smallest spacing are coarsened (semi-coarsening). The coupling of two
/// coarse cells is the open area between them over the distance of their centres, as on the finest grid: a grid without solids is rediscretised, and
/// a face half closed by solids couples half as strongly.
#[derive(Clone, Debug)]
pub(super) struct Multigrid {
    /// Finest first.
    levels: Vec<Level>,
    sweeps: usize,
}

#[derive(Clone, Debug)]
struct Level {
    operator: Operator<f32>,
    p: Coloured<f32>,
    b: Coloured<f32>,
    r: Coloured<f32>,
    /// Groups of cells whose mean neither relaxation nor the coarser level corrects.
    islands: Islands,
    /// Transfer to the next coarser level; none on the last.
    transfer: Option<Transfer<f32>>,
}

impl Multigrid {
    pub(super) fn new(system: &System) -> Self {
        let mut grid = CoarseningGrid::finest(system);
        let mut levels = vec![];
        loop {
            let (transfer, next) = grid.coarsen().unzip();
            levels.push(Level::new(&grid, transfer));
            match next {
                Some(next) => grid = next,
                None => return Self { levels, sweeps: SWEEPS[usize::from(system.has_solids())] },
            }
        }
    }

    /// Runs one cycle from zero with the right-hand side `scale r`.
    pub(super) fn cycle(&mut self, r: &Coloured<f64>, scale: f64) {
        let finest = &mut self.levels[0];
        let layout = finest.operator.layout;
        for (colour, (b, r)) in finest.b.iter_mut().zip(r).enumerate() {
            layout.for_each_plane(colour, b, |start, b| kernels::narrow(b, &r[start..], scale));
        }
        cycle(&mut self.levels, self.sweeps);
    }

    /// Result of the last cycle.
    pub(super) fn correction(&self) -> &Coloured<f32> {
        &self.levels[0].p
    }
}

fn cycle(levels: &mut [Level], sweeps: usize) {
    let Some((level, coarser)) = levels.split_first_mut() else { return };
    let Level { operator, p, b, r, islands, transfer } = level;
    let seams = operator.layout.seams();
    if seams {
        p.iter_mut().for_each(|p| p.fill(0.0));
    }
    operator.relax_from_zero(0, p, b);
    operator.relax(1, p, b);
    for _ in 1..sweeps {
        operator.relax(0, p, b);
        operator.relax(1, p, b);
    }
    if let (Some(transfer), Some(next)) = (transfer, coarser.first_mut()) {
        shift(islands, operator, p, b, true);
        operator.residual(0, p, b, r);
        // The black half-sweep left no residual in black cells, unless two of them are neighbours or were shifted.
        if seams || !islands.is_empty() {
            operator.residual(1, p, b, r);
        }
        transfer.restrict(r, &mut next.b);
        cycle(coarser, sweeps);
        transfer.prolong(&coarser[0].p, p);
        operator.layout.wrap(p);
        shift(islands, operator, p, b, false);
    }
    for _ in 0..sweeps {
        operator.relax(1, p, b);
        operator.relax(0, p, b);
    }
}

fn shift(islands: &Islands, operator: &Operator<f32>, p: &mut Coloured<f32>, b: &Coloured<f32>, forth: bool) {
    if !islands.is_empty() {
        islands.shift(p, b, forth);
        operator.layout.wrap(p);
    }
}

impl Level {
    fn new(grid: &CoarseningGrid, transfer: Option<Transfer<f32>>) -> Self {
        let islands = Islands::new(&grid.operator, &grid.outlets);
        let layout = grid.operator.layout;
        Self { operator: grid.operator.cast(), p: layout.zeros(), b: layout.zeros(), r: layout.zeros(), islands, transfer }
    }
}
