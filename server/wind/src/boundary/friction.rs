//! Friction at faces with a prescribed tangential velocity.
//!
//! The mirrored ghost `2w − u₁` has an error of `h²·∂²u/4`, so that the second difference at the value u₁ next to the face, half a cell from it, misses a quarter of the
//! curvature on every grid. That is still of second order in the velocity, but with an error several times that of the interior. Here the ghost lies on the parabola
//! through the wall's velocity w, u₁ and u₂, `(8w − 6u₁ + u₂)/3`: the second difference is 4/3 of the mirrored one, exact for parabolas and of first order otherwise
//! (of third in the velocity). Friction alone uses it. Fluxes of momentum keep the mirrored ghost, with which the air at the face has exactly the velocity w.
//!
//! The matrix of second differences is `W⁻¹·M` with the symmetric M of mirrored ghosts and W = 3/4 next to a wall and 1 elsewhere: its eigenvalues are real and
//! negative. Its symmetric part is negative definite too: with w = 0,
//! `Σ u·∂²u·h² = −4u₁² + (7/3)·u₁u₂ − u₂² − Σ (u_{i+1} − u_i)²`, summed from i = 2, so that friction never adds kinetic energy. Sums over the axes keep both
//! properties.

use crate::field::Field;
use crate::grid::{Grid, Location};
use crate::real::Real;

/// Second difference next to a wall, relative to that with a mirrored ghost.
pub(crate) const FACTOR: f64 = 4.0 / 3.0;

/// Whether values at `location` lie next to a wall at the low and the high face across `axis`: tangential velocity on an axis with more than one cell.
pub(crate) fn walls<R: Real>(grid: &Grid<R>, location: Location, axis: usize) -> [bool; 2] {
    let is_tangential = matches!(location, Location::Face(component) if component != axis);
    grid.boundary[axis].map(|face| is_tangential && grid.cells[axis] > 1 && face.fixes_tangential_velocity())
}

/// Upper bound of the largest eigenvalue of the negative second difference along `axis`, times h².
///
/// 4 without walls. A wave of two cells that shrinks by `2√3 − 3 = 0.464` per cell away from a wall has 8/√3 = 4.62; between two walls, n cells apart, it has more: 16/3
/// for two cells, and never more than `8/√3 + (16/3 − 8/√3)·2^(2−n)`.
pub(crate) fn largest_eigenvalue<R: Real>(grid: &Grid<R>, axis: usize) -> f64 {
    let n = grid.cells[axis];
    let alone = 8.0 / 3.0f64.sqrt();
    match grid.boundary[axis].into_iter().filter(|face| n > 1 && face.fixes_tangential_velocity()).count() {
        0 => 4.0,
        1 => alone,
        _ => alone + (16.0 / 3.0 - alone) * 0.5f64.powi(n.min(64) as i32 - 2),
    }
}

/// Adds to `target`, the velocity component after a step of friction of `gain_secs` (s) from `field` with mirrored ghosts, the missing third of the second difference
/// next to each wall.
pub(crate) fn complete<R: Real>(grid: &Grid<R>, viscosity_m2_per_s: f64, gain_secs: f64, field: &Field<R>, target: &mut Field<R>) {
    let strides = grid.strides();
    for axis in 0..3 {
        let (h, step) = (grid.spacing_m[axis], strides[axis]);
        let gain = R::of((FACTOR - 1.0) * viscosity_m2_per_s * gain_secs) / (h * h);
        let walls = walls(grid, target.location, axis);
        for side in (0..2).filter(|&side| walls[side]) {
            let next_to_wall = if side == 0 { 0 } else { grid.cells[axis] - 1 };
            let mut ranges = [0, 1, 2].map(|along| grid.free(target.location, along));
            ranges[axis] = next_to_wall..next_to_wall + 1;
            let [xs, ys, zs] = ranges;
            for k in zs {
                for j in ys.clone() {
                    for at in xs.clone().map(|i| grid.at([i, j, k])) {
                        let (u, twice) = (&field.data, field.data[at] + field.data[at]);
                        target.data[at] = target.data[at] + gain * (u[at - step] + u[at + step] - twice);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
#[path = "friction_tests.rs"]
mod tests;
