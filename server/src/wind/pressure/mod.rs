//! Taking the divergence out of a velocity.

mod coloured;
mod conjugate;
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

pub use iterative::{Convergence, Effort, Iterative, Method};
pub use system::{System, SystemError};

use super::parallel::for_each_chunk;
use super::separable::{Basis, Edge, Separable};
use super::{Boundary, Grid, Place, Real, Velocity};

/// How the Poisson equation of the projection is solved.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Pressure {
    /// By transforms along the axes: exact but for rounding, the fastest, and for boxes without solid cells only.
    #[default]
    Direct,
    /// By iteration, up to a residual or a number of sweeps.
    Iterative(Method, Effort),
}

/// Removes the gradient part of a velocity (Helmholtz–Hodge; 000 §2.3.6): what is left has no divergence beyond rounding, or the tolerance of an
/// iterative method.
pub struct Projection {
    solver: Solver,
    potential: Vec<f64>,
    divergence: Vec<f64>,
}

enum Solver {
    Direct(Separable),
    Iterative(Box<Iterative>, Effort),
}

impl Projection {
    /// Plans the solution on `grid` with these solid cells (one entry per cell, x fastest), and allocates all that projecting needs.
    pub fn new<R: Real>(grid: &Grid<R>, pressure: Pressure, solid: Option<&[bool]>) -> Self {
        let spacing_m = grid.spacing_m.map(R::wide);
        let edges = |axis: usize| {
            let edge = |face| if face == Boundary::Outflow { Edge::Dirichlet } else { Edge::Neumann };
            (!grid.wraps(axis)).then(|| grid.boundary[axis].map(edge))
        };
        let edges = [0, 1, 2].map(edges);
        let solver = match pressure {
            Pressure::Direct => {
                let bases = edges.map(|edges| edges.map_or(Basis::Wrap, Basis::Centres));
                Solver::Direct(Separable::new(grid.cells, spacing_m, bases))
            }
            Pressure::Iterative(method, effort) => {
                let system = System::new(grid.cells, spacing_m, edges, solid).expect("a grid and its solid cells fit");
                Solver::Iterative(Box::new(Iterative::new(system, method)), effort)
            }
        };
        Self { solver, potential: vec![0.0; grid.len()], divergence: vec![0.0; grid.len()] }
    }

    /// Makes `velocity`, whose boundary values are filled in, free of divergence, or gives it the divergence `inflow` (1/s, one per cell, or
    /// empty). Adds the gradient taken out, times `per_secs`, to `pull`. On wrapped axes momentum is kept to rounding.
    ///
    /// Direct in f32, at most 1e-6 of the rms divergence is left on boxes of up to 128 cells a side.
    pub fn project<R: Real>(
        &mut self,
        grid: &Grid<R>,
        velocity: &mut Velocity<R>,
        inflow: &[f64],
        pull: Option<(&mut Velocity<R>, f64)>,
    ) -> Convergence {
        let Self { solver, potential, divergence: source } = self;
        let sign = if matches!(solver, Solver::Direct(_)) { -1.0 } else { 1.0 };
        divergence(grid, velocity, sign, source);
        source.iter_mut().zip(inflow).for_each(|(source, &inflow)| *source -= sign * inflow);
        let (potential, convergence) = match solver {
            Solver::Direct(separable) => {
                separable.solve(0.0, source);
                (&*source, Convergence { residual: 0.0, sweeps: 0, tolerance: 0.0 })
            }
            Solver::Iterative(iterative, effort) => {
                let convergence = iterative.solve(source, potential, *effort);
                (&*potential, convergence)
            }
        };
        let (mut pull, per_secs) = match pull {
            Some((pull, per_secs)) => (Some(pull), R::of(per_secs)),
            None => (None, R::zero()),
        };
        for (axis, field) in velocity.0.iter_mut().enumerate() {
            subtract_gradient(grid, potential, axis, R::one(), &mut field.data);
            if let Some(pull) = &mut pull {
                subtract_gradient(grid, potential, axis, -per_secs, &mut pull.0[axis].data);
            }
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

/// Subtracts `share` of the gradient along `axis` of a cell-centred potential (m²/s; no ghosts) from the faces the flow decides. On faces of outflow the potential is 0.
fn subtract_gradient<R: Real>(grid: &Grid<R>, potential: &[f64], axis: usize, share: R, data: &mut [R]) {
    let [nx, ny, _] = grid.cells;
    let n = grid.cells[axis];
    let per_m = share.wide() / grid.spacing_m[axis].wide();
    let place = Place::Face(axis);
    let (xs, ys) = (grid.free(place, 0), grid.free(place, 1));
    let row = |j: usize, k: usize| &potential[nx * (j + ny * k)..][..nx];
    // The cells before and behind face i along the axis, and the sign with which each counts: beyond an outflow the mirror image of the opposite sign.
    let before = |i: usize| if i > 0 { (i - 1, 1.0) } else if grid.wraps(axis) { (n - 1, 1.0) } else { (0, -1.0) };
    let behind = |i: usize| if i < n { (i, 1.0) } else { (n - 1, -1.0) };
    super::field::for_each_plane(grid, grid.free(place, 2), data, |k, plane| {
        for j in ys.clone() {
            let start = grid.at([0, j, k]) % plane.len();
            if axis == 0 {
                let p = row(j, k);
                let out = &mut plane[start..][..nx + 1];
                for i in xs.clone().filter(|&i| i == 0 || i == nx) {
                    let ((a, sign_a), (b, sign_b)) = (before(i), behind(i));
                    out[i] = out[i] - R::of((sign_b * p[b] - sign_a * p[a]) * per_m);
                }
                for (u, pair) in out[1..nx].iter_mut().zip(p.windows(2)) {
                    *u = *u - R::of((pair[1] - pair[0]) * per_m);
                }
            } else {
                let index = if axis == 1 { j } else { k };
                let ((a, sign_a), (b, sign_b)) = (before(index), behind(index));
                let cells = |index: usize| if axis == 1 { row(index, k) } else { row(j, index) };
                let out = &mut plane[start..][..nx];
                for ((u, &p), &q) in out.iter_mut().zip(cells(a)).zip(cells(b)) {
                    *u = *u - R::of((sign_b * q - sign_a * p) * per_m);
                }
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::super::Boundary::{self, *};
    use super::super::{Place, boundary::close_walls};
    use super::*;

    fn rms(values: &[f64]) -> f64 {
        (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
    }

    /// A velocity with divergence at every scale: smooth waves as long as the box, and noise.
    fn divergent(grid: &Grid<f32>, noise: f32) -> Velocity<f32> {
        let mut velocity = Velocity::zeros(grid);
        let mut seed = 1u32;
        for (axis, field) in velocity.0.iter_mut().enumerate() {
            let extent = grid.extent_m(axis);
            field.fill(grid, |position| (std::f32::consts::TAU * position[axis] / extent).sin() * extent);
            for value in &mut field.data {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                *value += noise * (seed as f32 / u32::MAX as f32 - 0.5);
            }
        }
        close_walls(grid, &mut velocity);
        velocity
    }

    fn left_over(cells: [usize; 3], spacing_m: [f32; 3], boundary: [Boundary; 3], noise: f32) -> f64 {
        let grid = Grid { cells, spacing_m, boundary };
        let mut velocity = divergent(&grid, noise);
        let (mut before, mut after) = (vec![0.0; grid.len()], vec![0.0; grid.len()]);
        divergence(&grid, &velocity, &mut before);
        Projection::new(&grid).project(&grid, &mut velocity);
        divergence(&grid, &velocity, &mut after);
        rms(&after) / rms(&before)
    }

    #[test]
    fn projection_leaves_no_divergence() {
        let shapes = [
            ([8, 8, 8], [1.0; 3]),
            ([16, 16, 16], [0.5; 3]),
            ([32, 32, 32], [1.0; 3]),
            ([64, 64, 64], [1.0; 3]),
            ([32, 8, 32], [8.0, 2.0, 8.0]),
            ([64, 32, 64], [4.0, 1.0, 2.0]),
            ([12, 7, 30], [1.0, 3.0, 0.7]),
            ([1, 5, 9], [1.0; 3]),
        ];
        for (cells, spacing) in shapes {
            for boundary in [[Wrap; 3], [Wall; 3], [Wrap, Wall, Wrap], [Wall, Wrap, Wall]] {
                for noise in [0.0, 100.0] {
                    let left = left_over(cells, spacing, boundary, noise);
                    println!("{cells:?} {boundary:?} noise {noise}: {left:.1e}");
                    assert!(left <= 1e-6, "{cells:?} {boundary:?} noise {noise}: {left:e} of the divergence is left");
                }
            }
        }
    }

    #[test]
    fn projection_keeps_momentum_across_wraps() {
        let grid = Grid { cells: [16, 12, 20], spacing_m: [1.0, 2.0, 0.5], boundary: [Wrap; 3] };
        let mut velocity = divergent(&grid, 10.0);
        let momentum = |velocity: &Velocity<f32>| velocity.0.each_ref().map(|field| field.data.iter().map(|&x| f64::from(x)).sum::<f64>());
        let before = momentum(&velocity);
        Projection::new(&grid).project(&grid, &mut velocity);
        let size: f64 = velocity.0.iter().flat_map(|field| &field.data).map(|&x| f64::from(x.abs())).sum();
        for (before, after) in before.into_iter().zip(momentum(&velocity)) {
            assert!((after - before).abs() <= 1e-7 * size, "{before} became {after}, of {size}");
        }
    }

    #[test]
    fn projecting_twice_changes_nothing_more() {
        let grid = Grid { cells: [12, 6, 10], spacing_m: [1.0, 2.0, 0.5], boundary: [Wrap, Wall, Wall] };
        let (mut once, mut projection) = (Velocity::zeros(&grid), Projection::new(&grid));
        for (axis, field) in once.0.iter_mut().enumerate() {
            field.fill(&grid, |[x, y, z]| (x * 1.3 + axis as f64).sin() + y * z);
        }
        close_walls(&grid, &mut once);
        projection.project(&grid, &mut once);
        let mut twice = once.clone();
        projection.project(&grid, &mut twice);
        for (a, b) in once.0.iter().zip(&twice.0) {
            assert!(a.data.iter().zip(&b.data).all(|(a, b)| (a - b).abs() < 1e-12));
        }
    }

    #[test]
    fn poisson_solves_the_discrete_equation() {
        let grid = Grid { cells: [10, 4, 9], spacing_m: [0.5, 1.0, 2.0], boundary: [Wrap, Wall, Wall] };
        let exact: Vec<f64> = (0..grid.len()).map(|i| (i as f64 * 0.7).sin()).collect();
        let mean = exact.iter().sum::<f64>() / exact.len() as f64;
        // Minus the gradient of a potential has minus its Laplacian as divergence.
        let mut velocity = Velocity::zeros(&grid);
        subtract_gradient(&grid, &exact, &mut velocity);
        let mut solution = vec![0.0; grid.len()];
        divergence(&grid, &velocity, &mut solution);
        Poisson::new(&grid).solve(&mut solution);
        for (found, exact) in solution.iter().zip(&exact) {
            assert!((found + exact - mean).abs() < 1e-12);
        }
        assert_eq!(velocity.0[1].place, Place::Face(1));
    }
}
