//! Sweeps of relaxation: Jacobi, Gauss–Seidel, successive over-relaxation.

use super::coloured::{Coloured, apart, at, set};
use super::kernels;
use super::system::System;

/// Order in which a sweep updates the cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Order {
    /// All cells from the values of the previous sweep.
    Simultaneous,
    /// x fastest, then y, then z, each from the newest values.
    Lexicographic,
    /// All red cells, then all black ones.
    RedBlack,
}

/// A sweep and its weights: `p = keep p + gain (b + Σ c p_neighbour)`.
#[derive(Clone, Debug)]
pub(super) struct RelaxationSweep {
    order: Order,
    keep: Coloured<f64>,
    gain: Coloured<f64>,
    /// Red values before a simultaneous sweep, or the current rows of a lexicographic one.
    scratch: Coloured<f64>,
}

impl RelaxationSweep {
    /// Jacobi: every cell from the previous iterate; convergence factor `cos πh` for a unit cube open on all sides. In closed air the checkerboard
    /// mode would oscillate forever; there the sweep is damped by `2 / (2 + λ)`, λ the [slowest mode](System::slowest_mode), so that it decays as
    /// fast as the slowest mode does.
    pub(super) fn jacobi(system: &System) -> Self {
        let omega = if system.regions.is_empty() { 1.0 } else { 2.0 / (2.0 + system.slowest_mode()) };
        Self::new(system, Order::Simultaneous, |_| omega)
    }

    /// Gauss–Seidel in the order of Zhang's listing (§2.3.6); convergence factor `cos² πh`.
    pub(super) fn gauss_seidel(system: &System) -> Self {
        Self::new(system, Order::Lexicographic, |_| 1.0)
    }

    /// Red–black over-relaxation with `ω = 2 / (1 + √(1 − ρ²))`, ρ the spectral radius of Jacobi on the box without its solids; convergence factor `ω
    /// − 1` (Young 1971).
    ///
    /// On a periodic axis with an odd number of cells, two red or two black cells are neighbours and each uses the other's old value; their factor is
    /// limited so that `2D/ω − A` stays positive definite among the cells of a colour.
    pub(super) fn successive_over_relaxation(system: &System) -> Self {
        let radius = (1.0 - system.slowest_mode()).max(0.0);
        let omega = 2.0 / (1.0 + (1.0 - radius * radius).sqrt());
        let (layout, operator) = (system.operator.layout, &system.operator);
        Self::new(system, Order::RedBlack, |cell| {
            let l = layout.linear(cell);
            let seam = |axis: usize| {
                let (n, odd) = (layout.cells[axis], layout.wraps[axis] && layout.cells[axis] % 2 == 1);
                let low = if odd && cell[axis] == 1 { at(&operator.lower[axis], l) } else { 0.0 };
                let high = if odd && cell[axis] == n { at(&operator.lower[axis], l + layout.stride[axis]) } else { 0.0 };
                low + high
            };
            let fraction = (seam(0) + seam(1) + seam(2)) * at(&operator.inverse, l);
            if fraction > 0.0 { omega.min(SEAM_MARGIN * 2.0 / (1.0 + fraction)) } else { omega }
        })
    }

    fn new(system: &System, order: Order, omega: impl Fn([usize; 3]) -> f64) -> Self {
        let layout = system.operator.layout;
        let (mut keep, mut gain) = (layout.zeros(), layout.zeros());
        for cell in layout.coordinates() {
            let l = layout.linear(cell);
            let inverse = at(&system.operator.inverse, l);
            if inverse > 0.0 {
                set(&mut keep, l, 1.0 - omega(cell));
                set(&mut gain, l, omega(cell) * inverse);
            }
        }
        let scratch = match order {
            Order::Simultaneous => [keep[0].clone(), vec![]],
            Order::Lexicographic => [vec![0.0; layout.stride[1]], vec![0.0; layout.stride[1]]],
            Order::RedBlack => [vec![], vec![]],
        };
        Self { order, keep, gain, scratch }
    }

    /// One sweep over all cells.
    pub(super) fn sweep(&mut self, system: &System, p: &mut Coloured<f64>, b: &Coloured<f64>) {
        match self.order {
            Order::Simultaneous => {
                self.scratch[0].copy_from_slice(&p[0]);
                let (red, black) = apart(p, 0);
                self.half(system, 0, red, black, b);
                self.half(system, 1, &mut p[1], &self.scratch[0], b);
                system.operator.layout.wrap(p);
            }
            Order::RedBlack => {
                for colour in 0..2 {
                    let (own, other) = apart(p, colour);
                    self.half(system, colour, own, other, b);
                    system.operator.layout.wrap_after(colour, p);
                }
            }
            Order::Lexicographic => lexicographic(system, p, b, &mut self.scratch),
        }
    }

    fn half(&self, system: &System, colour: usize, own: &mut [f64], other: &[f64], b: &Coloured<f64>) {
        let operator = &system.operator;
        operator.layout.for_each_plane(colour, own, |start, p| {
            let around = operator.around(colour, start, p.len(), other);
            kernels::over_relax(p, &b[colour][start..], [&self.keep[colour][start..], &self.gain[colour][start..]], around);
        });
    }
}

/// Relaxation factor of cells at an odd seam, relative to the largest stable one.
const SEAM_MARGIN: f64 = 0.95;

/// One lexicographic sweep, row by row: first the contributions of the surrounding rows, for the whole row at once, then cell by cell that of the
/// cell before. `scratch` has room for a row of each colour. Ghosts above the box are refreshed on the way, so that the last cells of periodic axes
/// use the new first ones.
fn lexicographic(system: &System, p: &mut Coloured<f64>, b: &Coloured<f64>, scratch: &mut Coloured<f64>) {
    let operator = &system.operator;
    let layout = operator.layout;
    let [nx, ny, nz] = layout.cells;
    for (z, y) in (1..=nz).flat_map(|z| (1..=ny).map(move |y| (z, y))) {
        let first = layout.linear([1, y, z]);
        for (colour, scratch) in scratch.iter_mut().enumerate() {
            let (start, end) = ((first + 1 - colour) / 2, (first + nx + 1 - colour) / 2);
            let (inverse, around) = (&operator.inverse[colour][start..], operator.around(colour, start, end - start, &p[1 - colour]));
            kernels::relax_but_for_lower_x(&mut scratch[..end - start], &b[colour][start..], inverse, around);
        }
        let offsets = [first.div_ceil(2), first / 2];
        let mut before = at(p, first - 1);
        for l in first..first + nx {
            let mut value = scratch[l % 2][l / 2 - offsets[l % 2]];
            if l == first + nx - 1 && layout.wraps[0] {
                // The ghost above, read with the rest of the row, still had the old value of the row's first cell.
                let change = at(p, first) - at(p, l + 1);
                value += at(&operator.inverse, l) * at(&operator.lower[0], l + 1) * change;
            }
            value += at(&operator.inverse, l) * at(&operator.lower[0], l) * before;
            set(p, l, value);
            before = value;
        }
        for (axis, _) in [(1, y), (2, z)].into_iter().filter(|&(axis, at)| layout.wraps[axis] && at == 1) {
            for l in first..first + nx {
                let value = at(p, l);
                set(p, l + layout.stride[axis] * layout.cells[axis], value);
            }
        }
    }
    layout.wrap(p);
}
