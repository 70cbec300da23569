//! Projection: removal of the divergence of a velocity.

mod coarsen;
mod coloured;
mod conjugate;
pub(crate) mod immersed;
mod islands;
mod iterative;
mod kernels;
mod multigrid;
mod operator;
mod regions;
mod relax;
mod system;
#[cfg(test)]
mod tests;
mod transfer;

pub use iterative::{Convergence, Effort, Iterative, IterativeMethod};
pub use system::{System, SystemError};

use multiversion::multiversion;

use super::parallel::{for_each_chunk, for_each_chunk_pair};
use super::separable::{Basis, Edge, Separable};
use super::{Boundary, GHOST, Grid, Location, Real, Velocity};

/// Solver of the Poisson equation of the projection.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Pressure {
    /// Direct solution by transforms along the axes: exact to rounding and fastest; only for boxes without solid cells.
    #[default]
    Direct,
    /// Iteration down to a residual or up to a number of sweeps.
    Iterative(IterativeMethod, Effort),
}

/// Projection of a velocity (Helmholtz–Hodge; Zhang §2.3.6). The result is divergence-free to rounding, or to the tolerance of an iterative method.
pub struct Projection {
    solver: PressureSolver,
    potential: Vec<f64>,
    divergence: Vec<f64>,
}

enum PressureSolver {
    Direct(Box<Separable>),
    Iterative(Box<Iterative>, Effort),
}

impl Projection {
    /// Plans the solution on `grid` with the given solid cells (one entry per cell, x fastest), and allocates the work arrays.
    pub fn new<R: Real>(grid: &Grid<R>, pressure: Pressure, solid: Option<&[bool]>) -> Self {
        let spacing_m = grid.spacing_m.map(R::wide);
        let edges = |axis: usize| {
            let edge = |face: Boundary| if face.fixes_pressure() { Edge::Dirichlet } else { Edge::Neumann };
            (!grid.wraps(axis)).then(|| grid.boundary[axis].map(edge))
        };
        let edges = [0, 1, 2].map(edges);
        let solver = match pressure {
            Pressure::Direct => {
                let bases = edges.map(|edges| edges.map_or(Basis::Wrap, Basis::Centres));
                PressureSolver::Direct(Box::new(Separable::new(grid.cells, spacing_m, bases)))
            }
            Pressure::Iterative(method, effort) => {
                let system = System::new(grid.cells, spacing_m, edges, solid).expect("a grid and its solid cells fit");
                PressureSolver::Iterative(Box::new(Iterative::new(system, method)), effort)
            }
        };
        Self { solver, potential: vec![0.0; grid.len()], divergence: vec![0.0; grid.len()] }
    }

    /// Potential from which the next solve begins; `None` for the direct solver, which needs none.
    pub(super) fn guess(&self) -> Option<&[f64]> {
        matches!(self.solver, PressureSolver::Iterative(..)).then_some(&self.potential)
    }

    /// Mutable access to [`guess`](Self::guess).
    pub(super) fn guess_mut(&mut self) -> Option<&mut [f64]> {
        matches!(self.solver, PressureSolver::Iterative(..)).then_some(&mut self.potential)
    }

    /// Makes `velocity`, with its boundary values filled in, divergence-free, or gives it the divergence `inflow` (1/s, one per cell, or empty). Adds
    /// the subtracted gradient, times `per_secs`, to `pressure_gradient`. Momentum along periodic axes is conserved to rounding.
    ///
    /// With the direct solver in f32 at most 1e-6 of the rms divergence remains, in boxes of up to 128 cells per side.
    pub fn project<R: Real>(
        &mut self,
        grid: &Grid<R>,
        velocity: &mut Velocity<R>,
        inflow: &[f64],
        pressure_gradient: Option<(&mut Velocity<R>, f64)>,
    ) -> Convergence {
        let Self { solver, potential, divergence: source } = self;
        let sign = if matches!(solver, PressureSolver::Direct(_)) { -1.0 } else { 1.0 };
        divergence(grid, velocity, sign, source);
        source.iter_mut().zip(inflow).for_each(|(source, &inflow)| *source -= sign * inflow);
        let (potential, convergence) = match solver {
            PressureSolver::Direct(separable) => {
                separable.solve(0.0, source);
                (&*source, Convergence { residual: 0.0, sweeps: 0, tolerance: 0.0 })
            }
            PressureSolver::Iterative(iterative, effort) => {
                let convergence = iterative.solve(source, potential, *effort);
                (&*potential, convergence)
            }
        };
        let (mut pressure_gradient, per_secs) = match pressure_gradient {
            Some((pressure_gradient, per_secs)) => (Some(pressure_gradient), R::of(per_secs)),
            None => (None, R::zero()),
        };
        for (axis, field) in velocity.0.iter_mut().enumerate() {
            let pressure_gradient = pressure_gradient.as_mut().map(|pressure_gradient| &mut pressure_gradient.0[axis].data[..]);
            subtract_gradient(grid, potential, axis, &mut field.data, pressure_gradient, per_secs);
        }
        convergence
    }
}

/// Divergence (1/s) of each cell, times `sign`: net outflow through its faces per volume.
pub fn divergence<R: Real>(grid: &Grid<R>, velocity: &Velocity<R>, sign: f64, divergence: &mut [f64]) {
    let [nx, ny, _] = grid.cells;
    let strides = grid.strides();
    let per_m = grid.spacing_m.map(|h| sign / h.wide());
    for_each_chunk(divergence, nx * ny, |k, plane| {
        for (j, out) in plane.chunks_mut(nx).enumerate() {
            let at = grid.at([0, j, k]);
            let [[u0, u1], [v0, v1], [w0, w1]] = [0, 1, 2].map(|axis| {
                let data = &velocity.0[axis].data;
                [&data[at..][..nx], &data[at + strides[axis]..][..nx]]
            });
            for (i, out) in out.iter_mut().enumerate() {
                *out = (u1[i] - u0[i]).wide() * per_m[0] + (v1[i] - v0[i]).wide() * per_m[1] + (w1[i] - w0[i]).wide() * per_m[2];
            }
        }
    });
}

/// Subtracts the gradient along `axis` of a cell-centred potential (m²/s; no ghosts) from the interior faces, and adds it, times `per_secs`, to
/// `pressure_gradient`. On outflow faces the potential is 0.
fn subtract_gradient<R: Real>(
    grid: &Grid<R>,
    potential: &[f64],
    axis: usize,
    data: &mut [R],
    pressure_gradient: Option<&mut [R]>,
    per_secs: R,
) {
    let (location, plane) = (Location::Face(axis), grid.strides()[2]);
    let planes = grid.free(location, 2);
    let memory = plane * (planes.start + GHOST)..plane * (planes.end + GHOST);
    let data = &mut data[memory.clone()];
    match pressure_gradient {
        Some(pressure_gradient) => for_each_chunk_pair(data, plane, &mut pressure_gradient[memory], plane, |n, data, pressure_gradient| {
            gradient_of_plane(grid, potential, axis, planes.start + n, data, pressure_gradient, per_secs);
        }),
        None => for_each_chunk(data, plane, |n, data| gradient_of_plane(grid, potential, axis, planes.start + n, data, &mut [], per_secs)),
    }
}

/// [`subtract_gradient`] for plane `k`; `pressure_gradient` may be empty.
#[multiversion(targets("x86_64+avx2"))]
fn gradient_of_plane<R: Real>(
    grid: &Grid<R>,
    potential: &[f64],
    axis: usize,
    k: usize,
    data: &mut [R],
    pressure_gradient: &mut [R],
    per_secs: R,
) {
    let ([nx, ny, _], n) = (grid.cells, grid.cells[axis]);
    let per_m = grid.spacing_m[axis].wide().recip();
    let location = Location::Face(axis);
    let row = |j: usize, k: usize| &potential[nx * (j + ny * k)..][..nx];
    // The cells on either side of face i along the axis, with their weights: beyond an outflow, the mirror image with opposite sign.
    let before = |i: usize| {
        if i > 0 {
            (i - 1, per_m)
        } else if grid.wraps(axis) {
            (n - 1, per_m)
        } else {
            (0, -per_m)
        }
    };
    let behind = |i: usize| if i < n { (i, per_m) } else { (n - 1, -per_m) };
    let mut take = |at: usize, p: &[f64], q: &[f64], [weight_p, weight_q]: [f64; 2]| {
        let len = p.len();
        let (data, q) = (&mut data[at..][..len], &q[..len]);
        let slope = |i: usize| R::of(weight_q * q[i] - weight_p * p[i]);
        (0..len).for_each(|i| data[i] = data[i] - slope(i));
        if !pressure_gradient.is_empty() {
            let pressure_gradient = &mut pressure_gradient[at..][..len];
            (0..len).for_each(|i| pressure_gradient[i] = pressure_gradient[i] + per_secs * slope(i));
        }
    };
    for j in grid.free(location, 1) {
        let start = grid.at([0, j, 0]) % grid.strides()[2];
        if axis == 0 {
            let p = row(j, k);
            for i in grid.free(location, 0).filter(|&i| i == 0 || i == nx) {
                let ((a, weight_a), (b, weight_b)) = (before(i), behind(i));
                take(start + i, &p[a..=a], &p[b..=b], [weight_a, weight_b]);
            }
            take(start + 1, &p[..nx - 1], &p[1..], [per_m; 2]);
        } else {
            let index = if axis == 1 { j } else { k };
            let ((a, weight_a), (b, weight_b)) = (before(index), behind(index));
            let cells = |index: usize| if axis == 1 { row(index, k) } else { row(j, index) };
            take(start, cells(a), cells(b), [weight_a, weight_b]);
        }
    }
}

#[cfg(test)]
#[path = "projection_tests.rs"]
mod projection_tests;
