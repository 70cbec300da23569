//! Functions of the listings of Zhang §2.3.2–2.3.7 under their original names: cell by cell, x fastest, on one thread.
//!
//! Fields are located at cell centres; their first layer of ghosts is the boundary wall of Zhang, the second is unused. Differences from the listings:
//!
//! - **Eq. (4) and `diffuse`**: the system is `(1 + 6a)·x − a·Σneighbours = x0`; Eq. (4) lacks the parentheses. `a` is `ν·dt/h²`, not
//!   `dt·diff·LENGTH·HEIGHT·DEPTH`, which has the wrong unit.
//! - **`linear_solver`** takes a weight per axis, since cells need not be cubes: `a_x = ν·dt/h_x²` and so on, with `1 + 2(a_x + a_y + a_z)` in place of
//!   `1 + 6a`.
//! - **`project`** divides by the spacing of each axis but relaxes with the weights (1, 6), which is right only for cubes of 1 m: here `1/h²` per axis and
//!   `2·Σ 1/h²`. On cubes of 1 m both are the same.
//! - **The initial guess of `diffuse`** is the field before the step; the listing starts from the sources just added, which its `SWAP` leaves in the array.
//! - **An axis of one cell** has no neighbours along it (Zhang has cubes only): flow in a plane relaxes as it would in two dimensions.
//! - **Periodic walls**: Zhang names them without a listing. The wall takes the value of the cell at the opposite end, and paths that leave the box re-enter there.

use crate::sample::{self, Ends, Stencil};
use crate::{Boundary, Field, GHOST, Grid, Location, Real, Velocity};

/// Sweeps of the listings' `linear_solver`.
pub const SWEEPS: u32 = 20;

/// Type of a field at the boundary wall: the listings' `b`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A density or pressure: 0 in the listings.
    Scalar,
    /// The velocity component along this axis: 1 to 3 in the listings.
    Component(usize),
}

/// Fills in the boundary wall (Zhang §2.3.7). A periodic wall takes the value of the opposite cell. Others take the value of the adjacent cell; for
/// the normal velocity they take 0 ([`Boundary::FreeSlip`]) or its negative ([`Boundary::Reflect`]).
pub fn set_bound<R: Real>(grid: &Grid<R>, kind: Kind, x: &mut Field<R>) {
    let strides = grid.strides();
    for (axis, [a, b]) in [[1, 2], [0, 2], [0, 1]].into_iter().enumerate() {
        let at = |n: usize| n * strides[axis];
        let (first, last) = (at(GHOST), at(GHOST + grid.cells[axis] - 1));
        for (side, (wall, inside, opposite)) in [(first - at(1), first, last), (last + at(1), last, first)].into_iter().enumerate() {
            let (image, sign) = match grid.boundary[axis][side] {
                Boundary::Wrap => (opposite, R::one()),
                Boundary::Reflect if kind == Kind::Component(axis) => (inside, -R::one()),
                _ if kind == Kind::Component(axis) => (inside, R::zero()),
                _ => (inside, R::one()),
            };
            // The walls of earlier axes are included, so that edges and corners have values too.
            for m in GHOST - 1..=GHOST + grid.cells[b] {
                for n in GHOST - 1..=GHOST + grid.cells[a] {
                    let along = n * strides[a] + m * strides[b];
                    x.data[along + wall] = sign * x.data[along + image];
                }
            }
        }
    }
}

/// Gauss–Seidel relaxation of `diagonal·x − Σ weights·(neighbours along the axis) = x0`, by the given number of sweeps.
///
/// The term that depends on the preceding cell comes last in the sum, which shortens the dependency chain of the processor.
pub fn linear_solver<R: Real>(grid: &Grid<R>, kind: Kind, x: &mut Field<R>, x0: &Field<R>, weights: [R; 3], diagonal: R, sweeps: u32) {
    let [nx, ny, nz] = grid.cells;
    let [_, sy, sz] = grid.strides();
    let [wx, wy, wz] = weights;
    for _ in 0..sweeps {
        for k in 0..nz {
            for j in 0..ny {
                let at = grid.at([0, j, k]);
                let x0 = &x0.data[at..][..nx];
                // The row from wall to wall, and the surrounding rows.
                let (before, rest) = x.data.split_at_mut(at - 1);
                let (row, after) = rest.split_at_mut(nx + 2);
                let [low_y, low_z] = [sy, sz].map(|step| &before[at - step..][..nx]);
                let [high_y, high_z] = [sy, sz].map(|step| &after[step - nx - 1..][..nx]);
                for i in 0..nx {
                    let across = wy * (low_y[i] + high_y[i]) + wz * (low_z[i] + high_z[i]);
                    row[i + 1] = (x0[i] + across + wx * row[i + 2] + wx * row[i]) / diagonal;
                }
            }
        }
        set_bound(grid, kind, x);
    }
}

/// One backward Euler step of the heat equation from `x0` to `x`, solved approximately by [`SWEEPS`] sweeps.
pub fn diffuse<R: Real>(grid: &Grid<R>, kind: Kind, x: &mut Field<R>, x0: &Field<R>, diffusivity_m2_per_s: f64, dt_secs: f64) {
    let a = weights(grid, diffusivity_m2_per_s * dt_secs);
    x.data.copy_from_slice(&x0.data);
    linear_solver(grid, kind, x, x0, a, R::one() + twice_sum(a), SWEEPS);
}

/// Advects `d0` by one step into `d`: the value at the start of a straight path back from each centre, interpolated linearly along each axis. Paths
/// end at faces that are not periodic.
pub fn advect<R: Real>(grid: &Grid<R>, kind: Kind, d: &mut Field<R>, d0: &Field<R>, velocity: &Velocity<R>, dt_secs: f64) {
    let [nx, ny, nz] = grid.cells;
    let strides = grid.strides();
    let ends = [0, 1, 2].map(|axis| Ends::of(grid, Location::Centre, axis));
    let cells_per_speed = grid.spacing_m.map(|h| R::of(dt_secs) / h);
    for k in 0..nz {
        for j in 0..ny {
            for i in 0..nx {
                let at = grid.at([i, j, k]);
                let path = |axis: usize| -cells_per_speed[axis] * velocity.0[axis].data[at];
                let from = [Stencil::new(i, path(0), ends[0]), Stencil::new(j, path(1), ends[1]), Stencil::new(k, path(2), ends[2])];
                d.data[at] = sample::trilinear(&d0.data, strides, &from);
            }
        }
    }
    set_bound(grid, kind, d);
}

/// Subtracts the gradient of a pressure `p`, approximated by the given number of sweeps, from the velocity (Zhang §2.3.6), so that its divergence
/// becomes `inflow` (1/s, one value per cell, x fastest; or empty for none). Leaves the right-hand side, `inflow` minus the previous divergence, in `div`.
///
/// Some divergence remains even with unlimited sweeps: central differences of central differences are not the Laplacian that is relaxed.
pub fn project<R: Real>(grid: &Grid<R>, velocity: &mut Velocity<R>, p: &mut Field<R>, div: &mut Field<R>, inflow: &[f64], sweeps: u32) {
    let [nx, ny, nz] = grid.cells;
    let strides = grid.strides();
    let half_per_m = grid.spacing_m.map(|h| R::of(0.5) / h);
    for k in 0..nz {
        for j in 0..ny {
            let at = grid.at([0, j, k]);
            for i in at..at + nx {
                div.data[i] = -divergence(velocity, i, strides, half_per_m);
            }
            for (div, &inflow) in div.data[at..].iter_mut().zip(inflow.iter().skip(nx * (j + ny * k)).take(nx)) {
                *div = *div + R::of(inflow);
            }
        }
    }
    p.data.fill(R::zero());
    let weights = weights(grid, 1.0);
    let diagonal = twice_sum(weights);
    // A box of one cell has no pressure gradient.
    if diagonal > R::zero() {
        linear_solver(grid, Kind::Scalar, p, div, weights, diagonal, sweeps);
    }
    for (axis, field) in velocity.0.iter_mut().enumerate() {
        for k in 0..nz {
            for j in 0..ny {
                let at = grid.at([0, j, k]);
                let [low, high] = [at - strides[axis], at + strides[axis]].map(|from| &p.data[from..][..nx]);
                for (i, u) in field.data[at..][..nx].iter_mut().enumerate() {
                    *u = *u - half_per_m[axis] * (high[i] - low[i]);
                }
            }
        }
        set_bound(grid, Kind::Component(axis), field);
    }
}

/// Divergence (1/s) at an index in memory, by central differences.
pub(super) fn divergence<R: Real>(velocity: &Velocity<R>, at: usize, strides: [usize; 3], half_per_m: [R; 3]) -> R {
    let along = |axis: usize| half_per_m[axis] * (velocity.0[axis].data[at + strides[axis]] - velocity.0[axis].data[at - strides[axis]]);
    along(0) + along(1) + along(2)
}

/// Root mean square of the residual of the pressure equation, over that of its right-hand side; 0 if that is 0.
pub(super) fn residual<R: Real>(grid: &Grid<R>, p: &Field<R>, div: &Field<R>) -> f64 {
    let strides = grid.strides();
    let weights = weights(grid, 1.0);
    let (mut lacking, mut given) = (0.0, 0.0);
    for row in p.rows(grid) {
        for at in row..row + grid.cells[0] {
            let here = p.data[at] + p.data[at];
            let bent =
                (0..3).fold(R::zero(), |sum, axis| sum + weights[axis] * (p.data[at - strides[axis]] + p.data[at + strides[axis]] - here));
            lacking += (div.data[at] + bent).wide().powi(2);
            given += div.data[at].wide().powi(2);
        }
    }
    if given > 0.0 { (lacking / given).sqrt() } else { 0.0 }
}

/// `amount_m2/h²` for each axis with more than one cell.
fn weights<R: Real>(grid: &Grid<R>, amount_m2: f64) -> [R; 3] {
    [0, 1, 2].map(|axis| if grid.cells[axis] > 1 { R::of(amount_m2) / (grid.spacing_m[axis] * grid.spacing_m[axis]) } else { R::zero() })
}

fn twice_sum<R: Real>([x, y, z]: [R; 3]) -> R {
    let sum = x + y + z;
    sum + sum
}
