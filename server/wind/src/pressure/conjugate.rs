//! Preconditioned conjugate gradients.

use super::coloured::Coloured;
use super::iterative::{Convergence, Effort};
use super::kernels;
use super::multigrid::Multigrid;
use super::system::System;

/// Approximate inverse of the matrix.
#[derive(Clone, Debug)]
pub(super) enum Preconditioner {
    /// The inverse of the diagonal.
    Jacobi,
    /// One V-cycle.
    Multigrid(Box<Multigrid>),
}

/// Conjugate gradients (Hestenes & Stiefel, J. Res. NBS 49, 1952) with the Polak–Ribière direction, which tolerates a preconditioner that is
/// symmetric only to single precision (Golub & Ye 1999).
#[derive(Clone, Debug)]
pub(super) struct Conjugate {
    preconditioner: Preconditioner,
    z: Coloured<f64>,
    direction: Coloured<f64>,
    product: Coloured<f64>,
}

impl Conjugate {
    pub(super) fn new(system: &System, preconditioner: Preconditioner) -> Self {
        let layout = system.operator.layout;
        Self { preconditioner, z: layout.zeros(), direction: layout.zeros(), product: layout.zeros() }
    }

    /// Iterates on `p` until the norm of the residual `r`, relative to `b_norm`, is within the tolerance or the sweeps are used up.
    pub(super) fn solve(
        &mut self,
        system: &System,
        [p, r]: [&mut Coloured<f64>; 2],
        b: &Coloured<f64>,
        b_norm: f64,
        partial: &mut [f64],
        effort: Effort,
    ) -> Convergence {
        let operator = &system.operator;
        let layout = &operator.layout;
        let (mut sweeps, mut limit) = (0, effort.sweeps);
        // When the recurrence reports convergence, the true residual is checked, and the iteration restarts if it is too large.
        loop {
            let residual = operator.residual_sum(p, b, r, partial).sqrt() / b_norm;
            if residual <= effort.tolerance || sweeps >= limit {
                return Convergence { residual, sweeps, tolerance: effort.tolerance };
            }
            let (mut rz_old, mut alpha, mut r_norm) = (0.0, 0.0, residual * b_norm);
            loop {
                let rz = self.precondition(system, r, r_norm, partial);
                // z·(r − r_old) / (r·z)_old, as r − r_old = −α q.
                let beta = if rz_old > 0.0 { -alpha * self.z_dot_product(system, partial) / rz_old } else { 0.0 };
                for colour in 0..2 {
                    let z = &self.z[colour];
                    layout.for_each_plane(colour, &mut self.direction[colour], |start, d| kernels::scale_add(d, &z[start..], beta));
                }
                layout.wrap(&mut self.direction);
                let curvature = operator.apply_sum(&self.direction, &mut self.product, partial);
                if !(curvature > 0.0 && rz > 0.0) {
                    // Only rounding error is left.
                    limit = sweeps;
                    break;
                }
                alpha = rz / curvature;
                rz_old = rz;
                let mut sum = 0.0;
                for colour in 0..2 {
                    let (d, q) = (&self.direction[colour], &self.product[colour]);
                    layout.for_each_plane(colour, &mut p[colour], |start, p| kernels::add_scaled(p, &d[start..], alpha));
                    sum += layout.sum_planes(colour, &mut r[colour], partial, |start, r| {
                        kernels::add_scaled(r, &q[start..], -alpha);
                        kernels::dot(r, r)
                    });
                }
                layout.wrap(p);
                r_norm = sum.sqrt();
                sweeps += 1;
                if r_norm / b_norm <= effort.tolerance || sweeps >= limit {
                    break;
                }
            }
        }
    }

    /// Applies the preconditioner to `r`, giving z; returns `r·z`.
    fn precondition(&mut self, system: &System, r: &Coloured<f64>, r_norm: f64, partial: &mut [f64]) -> f64 {
        let layout = &system.operator.layout;
        if let Preconditioner::Multigrid(multigrid) = &mut self.preconditioner {
            multigrid.cycle(r, 1.0 / r_norm);
        }
        let mut sum = 0.0;
        for (colour, r) in r.iter().enumerate() {
            let preconditioner = &self.preconditioner;
            sum += layout.sum_planes(colour, &mut self.z[colour], partial, |start, z| {
                let r = &r[start..][..z.len()];
                match preconditioner {
                    Preconditioner::Jacobi => kernels::multiply(z, &system.operator.inverse[colour][start..], r),
                    Preconditioner::Multigrid(multigrid) => kernels::widen(z, &multigrid.correction()[colour][start..], r_norm),
                }
                kernels::dot(r, z)
            });
        }
        sum
    }

    fn z_dot_product(&mut self, system: &System, partial: &mut [f64]) -> f64 {
        let mut sum = 0.0;
        for (colour, q) in self.product.iter().enumerate() {
            let z = &mut self.z[colour];
            sum += system.operator.layout.sum_planes(colour, z, partial, |start, z| kernels::dot(z, &q[start..][..z.len()]));
        }
        sum
    }
}
