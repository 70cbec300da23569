//! Iterative solvers of the pressure equation: methods, stopping criterion, convergence.

use super::coloured::Coloured;
use super::conjugate::{Conjugate, Preconditioner};
use super::kernels;
use super::multigrid::Multigrid;
use super::relax::RelaxationSweep;
use super::system::System;

/// Sweeps between two evaluations of the residual, for methods that do not compute it anyway.
const SWEEPS_PER_CHECK: u32 = 4;

/// Iterative method.
///
/// Work and memory traffic per sweep and cell, in double precision:
///
/// | method | operations | bytes |
/// |---|---|---|
/// | Jacobi, Gauss–Seidel, SOR | 15 | 64 |
/// | residual, every 4 sweeps | 16 | 64 |
/// | conjugate gradients | 28 | 160 |
/// | multigrid | 28, and 60 in single precision on the finest grid | 160 + 112 |
///
/// Multigrid's coarser grids add a seventh to its single-precision part if all axes are coarsened, and double it if only one is; among solids it
/// relaxes twice, for 40 operations and 80 bytes more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IterativeMethod {
    /// Every cell from the previous iterate. The error falls by `cos(π/n)` per sweep for `n` cells along each axis: about `n²` sweeps. In air without
    /// an open edge, damped just enough for the checkerboard mode to decay.
    Jacobi,
    /// Gauss–Seidel in lexicographic order, x fastest (Zhang §2.3.6): needs half the sweeps of Jacobi, but runs on one thread.
    GaussSeidel,
    /// Red–black successive over-relaxation with the optimal factor for the box without its solids: about `2 n` sweeps.
    Sor,
    /// Conjugate gradients, preconditioned by the diagonal: about `2 n` sweeps, with or without solids.
    ConjugateGradients,
    /// Conjugate gradients preconditioned by one symmetric V-cycle (Tatebe, The multigrid preconditioned conjugate gradient method, 1993): the number
    /// of cycles hardly depends on `n`.
    Multigrid,
}

/// Stopping criterion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Tolerance: root mean square of the residual relative to that of the right-hand side. Values down to 1e-12 can be reached; 0 uses all
    /// sweeps.
    pub tolerance: f64,
    /// Maximum number of sweeps, iterations or cycles.
    pub sweeps: u32,
}

/// Result of an iterative solve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Convergence {
    /// Root mean square of `f − ∇²p`, relative to that of f; 0 where f is 0.
    pub residual: f64,
    /// Number of sweeps, iterations or cycles.
    pub sweeps: u32,
    /// The requested tolerance.
    pub tolerance: f64,
}

impl Convergence {
    /// True if the residual is within the tolerance.
    pub fn met(&self) -> bool {
        self.residual <= self.tolerance
    }
}

/// A solver for one [`System`], with its work arrays.
#[derive(Clone, Debug)]
pub struct Iterative {
    system: System,
    solver: LinearSolver,
    /// Right-hand side in natural order.
    natural: Vec<f64>,
    b: Coloured<f64>,
    p: Coloured<f64>,
    r: Coloured<f64>,
    /// Partial sums, one per chunk.
    partial: Vec<f64>,
    /// Sums, one per closed region.
    sums: Vec<f64>,
}

#[derive(Clone, Debug)]
enum LinearSolver {
    Relaxation(RelaxationSweep),
    Conjugate(Conjugate),
}

impl Iterative {
    /// Creates a solver of `system` by `method`.
    pub fn new(system: System, method: IterativeMethod) -> Self {
        let solver = match method {
            IterativeMethod::Jacobi => LinearSolver::Relaxation(RelaxationSweep::jacobi(&system)),
            IterativeMethod::GaussSeidel => LinearSolver::Relaxation(RelaxationSweep::gauss_seidel(&system)),
            IterativeMethod::Sor => LinearSolver::Relaxation(RelaxationSweep::successive_over_relaxation(&system)),
            IterativeMethod::ConjugateGradients => LinearSolver::Conjugate(Conjugate::new(&system, Preconditioner::Jacobi)),
            IterativeMethod::Multigrid => {
                LinearSolver::Conjugate(Conjugate::new(&system, Preconditioner::Multigrid(Box::new(Multigrid::new(&system)))))
            }
        };
        let layout = system.operator.layout;
        let (b, p, r) = (layout.zeros(), layout.zeros(), layout.zeros());
        let natural = vec![0.0; layout.cells.iter().product()];
        let (partial, sums) = (vec![0.0; layout.chunks()], vec![0.0; system.regions.count()]);
        Self { system, solver, natural, b, p, r, partial, sums }
    }

    /// The system of equations.
    pub fn system(&self) -> &System {
        &self.system
    }

    /// Solves `∇²p = f`, both with one value per cell, x fastest. `p` is the initial guess on entry (zeros if there is none). A guess worse than
    /// zeros is scaled to its best multiple. No method's sweeps raise the energy norm of the error, so this norm never exceeds that of zeros.
    /// Values in solid cells are ignored and set to 0.
    ///
    /// Gives the same bits on any number of threads and allocates nothing. Non-finite input gives a non-finite residual, which is never
    /// [met](Convergence::met).
    ///
    /// # Panics
    /// If a slice does not have one value for each cell.
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
        // A constant right-hand side leaves only rounding error.
        if given.is_finite() && b_norm <= 8.0 * f64::EPSILON * given {
            p.fill(0.0);
            return Convergence { residual: 0.0, sweeps: 0, tolerance: effort.tolerance };
        }
        layout.load(natural, b, |v| v);
        system.mask(p);
        system.regions.remove_means(p, sums);
        layout.load(p, coloured, |v| v);
        layout.wrap(coloured);
        // A guess worse than zeros is scaled to its best multiple: otherwise a few sweeps could add energy to the air.
        let curvature = system.operator.apply_sum(coloured, r, partial);
        let scale = kernels::dot(natural, p) / curvature;
        if curvature > 0.0 && scale < 0.5 {
            coloured.iter_mut().flatten().for_each(|p| *p *= scale);
        }

        let convergence = match solver {
            LinearSolver::Conjugate(conjugate) => conjugate.solve(system, [coloured, r], b, b_norm, partial, effort),
            LinearSolver::Relaxation(relaxation) => {
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
