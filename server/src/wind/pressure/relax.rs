//! Sweeps of relaxation: Jacobi, Gauss–Seidel, successive over-relaxation.

use super::coloured::{Coloured, apart, at, set};
use super::kernels;
use super::system::System;

/// How a sweep goes through the cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Order {
    /// Every cell from the values before the sweep.
    Simultaneous,
    /// x fastest, then y, then z, each from the newest values.
    Lexicographic,
    /// All red cells, then all black ones.
    RedBlack,
}

/// A sweep and its weights: `p = keep p + gain (b + Σ c p_neighbour)`.
#[derive(Clone, Debug)]
pub(super) struct Relaxation {
    order: Order,
    keep: Coloured<f64>,
    gain: Coloured<f64>,
    /// Red values before the sweep.
    old: Vec<f64>,
}

impl Relaxation {
    /// Jacobi: every cell from the last iterate; factor `cos πh` for a cube of side 1 open all around. In closed air the checkerboard would swing for ever;
    /// there the sweep is damped by `2 / (2 + λ)`, λ the [slowest mode](System::slowest_mode), so that it decays as fast as the slowest mode does.
    pub(super) fn jacobi(system: &System) -> Self {
        let omega = if system.regions.is_empty() { 1.0 } else { 2.0 / (2.0 + system.slowest_mode()) };
        Self::new(system, Order::Simultaneous, |_| omega)
    }

    /// Gauss–Seidel in the order of 000's listing (§2.3.6); factor `cos² πh`.
    pub(super) fn gauss_seidel(system: &System) -> Self {
        Self::new(system, Order::Lexicographic, |_| 1.0)
    }

    /// Red–black over-relaxation with `ω = 2 / (1 + √(1 − ρ²))`, ρ the spectral radius of Jacobi on the box without its solids; factor `ω − 1`
    /// (Young, Iterative Solution of Large Linear Systems, 1971).
    ///
    /// Where an odd number of cells wraps, two red or two black cells meet, each taking the other's old value; these relax by no more than keeps
    /// `2D/ω − A` positive definite among the cells of a colour.
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
            let share = (seam(0) + seam(1) + seam(2)) * at(&operator.inverse, l);
            if share > 0.0 { omega.min(SEAM_MARGIN * 2.0 / (1.0 + share)) } else { omega }
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
        let old = if order == Order::Simultaneous { keep[0].clone() } else { vec![] };
        Self { order, keep, gain, old }
    }

    /// One sweep over all cells.
    pub(super) fn sweep(&mut self, system: &System, p: &mut Coloured<f64>, b: &Coloured<f64>) {
        match self.order {
            Order::Simultaneous => {
                self.old.copy_from_slice(&p[0]);
                let (red, black) = apart(p, 0);
                self.half(system, 0, red, black, b);
                self.half(system, 1, &mut p[1], &self.old, b);
                (0..2).for_each(|colour| system.operator.layout.wrap(colour, p));
            }
            Order::RedBlack => {
                for colour in 0..2 {
                    let (own, other) = apart(p, colour);
                    self.half(system, colour, own, other, b);
                    system.operator.layout.wrap(colour, p);
                }
            }
            Order::Lexicographic => lexicographic(system, p, b),
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

/// Share of the largest stable relaxation that cells at an odd seam get.
const SEAM_MARGIN: f64 = 0.95;

/// One cell after the other; ghosts are refreshed after the sweep.
fn lexicographic(system: &System, p: &mut Coloured<f64>, b: &Coloured<f64>) {
    let operator = &system.operator;
    let layout = operator.layout;
    let [nx, ny, nz] = layout.cells;
    for z in 1..=nz {
        for y in 1..=ny {
            let start = layout.linear([1, y, z]);
            for l in start..start + nx {
                let along = |axis: usize| {
                    let (below, above) = (l - layout.stride[axis], l + layout.stride[axis]);
                    at(&operator.lower[axis], l) * at(p, below) + at(&operator.lower[axis], above) * at(p, above)
                };
                let value = (at(b, l) + along(0) + along(1) + along(2)) * at(&operator.inverse, l);
                set(p, l, value);
            }
        }
    }
    (0..2).for_each(|colour| layout.wrap(colour, p));
}
