//! The solvers behind one door: methods, effort, convergence.

use super::coloured::Coloured;
use super::conjugate::{Conjugate, Preconditioner};
use super::kernels;
use super::multigrid::Multigrid;
use super::relax::Relaxation;
use super::system::System;

/// Sweeps between two looks at the residual, for the methods that do not get it for nothing.
const SWEEPS_PER_CHECK: u32 = 4;

/// How the equation is solved.
///
/// Work and memory traffic of a sweep, for each cell, in double precision:
///
/// | method | operations | bytes |
/// |---|---|---|
/// | Jacobi, Gauss–Seidel, SOR | 15 | 64 |
/// | a look at the residual, every 4 sweeps | 16 | 64 |
/// | conjugate gradients | 28 | 160 |
/// | multigrid | 28, and 60 in single precision on the finest grid | 160 + 112 |
///
/// Multigrid's coarser grids add a seventh to its single-precision part where all axes are coarsened, as much again where one is; among solids it relaxes
/// twice, for 40 operations and 80 bytes more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Every cell from the last iterate. The error falls by `cos(π/n)` a sweep for `n` cells along each axis: about `n²` sweeps. In air without an open
    /// edge damped just enough for the checkerboard not to swing for ever.
    Jacobi,
    /// Cell after cell, x fastest, from the newest values (000 §2.3.6): half the sweeps of Jacobi, on one thread.
    GaussSeidel,
    /// Red–black successive over-relaxation with the box's best factor: about `2 n` sweeps. Solids are not reckoned with in that factor.
    Sor,
    /// Conjugate gradients, preconditioned by the diagonal: about `2 n` sweeps, whatever the solids.
    ConjugateGradients,
    /// Conjugate gradients preconditioned by one symmetric V-cycle (Tatebe, The multigrid preconditioned conjugate gradient method, 1993): a number of
    /// cycles that hardly depends on `n`.
    Multigrid,
}

/// How far to go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Root mean square of the residual, relative to that of the right-hand side, at which to stop. 1e-12 and up can be reached; 0 uses all sweeps.
    pub tolerance: f64,
    /// Most sweeps, iterations or cycles.
    pub sweeps: u32,
}

/// How far it went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Convergence {
    /// Root mean square of `f − ∇²p`, relative to that of f; 0 where f is 0.
    pub residual: f64,
    /// Sweeps, iterations or cycles used.
    pub sweeps: u32,
    /// The tolerance asked for.
    pub tolerance: f64,
}

impl Convergence {
    /// True if the residual is within the tolerance.
    pub fn met(&self) -> bool {
        self.residual <= self.tolerance
    }
}

/// A solver for one [`System`], with all its memory.
#[derive(Clone, Debug)]
pub struct Iterative {
    system: System,
    solver: Solver,
    /// Right-hand side as an array of the cells.
    natural: Vec<f64>,
    b: Coloured<f64>,
    p: Coloured<f64>,
    r: Coloured<f64>,
    /// Sums of chunks.
    partial: Vec<f64>,
    /// Sums of closed regions.
    sums: Vec<f64>,
}

#[derive(Clone, Debug)]
enum Solver {
    Relaxation(Relaxation),
    Conjugate(Conjugate),
}

impl Iterative {
    /// Allocates all that `method` needs for `system`.
    pub fn new(system: System, method: Method) -> Self {
        let solver = match method {
            Method::Jacobi => Solver::Relaxation(Relaxation::jacobi(&system)),
            Method::GaussSeidel => Solver::Relaxation(Relaxation::gauss_seidel(&system)),
            Method::Sor => Solver::Relaxation(Relaxation::successive_over_relaxation(&system)),
            Method::ConjugateGradients => Solver::Conjugate(Conjugate::new(&system, Preconditioner::Jacobi)),
            Method::Multigrid => Solver::Conjugate(Conjugate::new(&system, Preconditioner::Multigrid(Box::new(Multigrid::new(&system))))),
        };
        let layout = system.operator.layout;
        let (b, p, r) = (layout.zeros(), layout.zeros(), layout.zeros());
        let natural = vec![0.0; layout.cells.iter().product()];
        let (partial, sums) = (vec![0.0; layout.chunks()], vec![0.0; system.regions.count()]);
        Self { system, solver, natural, b, p, r, partial, sums }
    }

    /// The equation solved.
    pub fn system(&self) -> &System {
        &self.system
    }

    /// Solves `∇²p = f`, both one value a cell, x fastest. `p` comes with a first guess, zeros if there is none; if it is worse
    /// than zeros, its best multiple is taken, so that the energy norm of the error never is above that of zeros: no method's sweeps raise it. Values in solid cells are ignored and
    /// become 0.
    ///
    /// Gives the same bits on any number of threads and allocates nothing. Values that are not finite end in a residual that is not, and never
    /// [met](Convergence::met).
    ///
    /// # Panics
    /// If a slice has not one value for each cell.
    pub fn solve(&mut self, f: &[f64], p: &mut [f64], effort: Effort) -> Convergence {
        assert!(f.len() == self.natural.len() && p.len() == f.len(), "one value for each of {} cells", self.natural.len());
        let Self { system, solver, natural, b, p: coloured, r, partial, sums } = self;
        let layout = &system.operator.layout;

        // The matrix is −∇², positive semidefinite.
        natural.iter_mut().zip(f).for_each(|(b, f)| *b = -f);
        system.mask(natural);
        let given = kernels::dot(natural, natural).sqrt();
        system.regions.remove_means(natural, sums);
        let b_norm = kernels::dot(natural, natural).sqrt();
        // All that is left of a constant is rounding.
        if given.is_finite() && b_norm <= 8.0 * f64::EPSILON * given {
            p.fill(0.0);
            return Convergence { residual: 0.0, sweeps: 0, tolerance: effort.tolerance };
        }
        layout.load(natural, b, |v| v);
        system.mask(p);
        system.regions.remove_means(p, sums);
        layout.load(p, coloured, |v| v);
        layout.wrap(coloured);
        // Of a guess worse than zeros the best multiple: if few sweeps follow, it would put energy into the air.
        let curvature = system.operator.apply_sum(coloured, r, partial);
        let scale = kernels::dot(natural, p) / curvature;
        if curvature > 0.0 && scale < 0.5 {
            coloured.iter_mut().flatten().for_each(|p| *p *= scale);
        }

        let convergence = match solver {
            Solver::Conjugate(conjugate) => conjugate.solve(system, [coloured, r], b, b_norm, partial, effort),
            Solver::Relaxation(relaxation) => {
                let mut sweeps = 0;
                loop {
                    let residual = system.operator.residual_sum(coloured, b, r, partial).sqrt() / b_norm;
                    let left = effort.sweeps - sweeps;
                    if residual <= effort.tolerance || left == 0 {
                        break Convergence { residual, sweeps, tolerance: effort.tolerance };
                    }
                    (0..left.min(SWEEPS_PER_CHECK)).for_each(|_| relaxation.sweep(system, coloured, b));
                    sweeps += left.min(SWEEPS_PER_CHECK);
                }
            }
        };
        layout.store(coloured, p);
        system.regions.remove_means(p, sums);
        convergence
    }
}
