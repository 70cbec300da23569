//! Diffusion schemes.
//!
//! With cells of metres, ν·dt/h² is far below the limit of the explicit scheme, which costs one sweep with seven reads per cell, a small part of an
//! implicit solve.

mod implicit;

pub use implicit::Implicit;

use super::boundary::friction::{self, largest_eigenvalue};
use super::field::for_each_plane;
use super::{Diffusion, Field, Grid, Real};

/// Longest stable step (s) of [`explicit`]: `2 / (ν·Σ λ/h²)` with the largest eigenvalue λ = 4 of each second difference, which is `a = ν·dt/h² = 1/6` on cubes. Above
/// it the checkerboard mode grows.
///
/// Across faces that prescribe the tangential velocity λ is larger: 8/√3 = 4.62 where they are many cells apart, up to 16/3 between two of them. For a
/// concentration, to which such faces are closed, the limit is then up to a quarter below what it could be. Infinite for a diffusivity of 0.
pub fn stable_dt_secs<R: Real>(grid: &Grid<R>, diffusivity_m2_per_s: f64) -> f64 {
    let curvature: f64 =
        (0..3).map(|axis| largest_eigenvalue(grid, axis) * (grid.spacing_m[axis].wide() * grid.spacing_m[axis].wide()).recip()).sum();
    2.0 * (diffusivity_m2_per_s * curvature).recip()
}

/// Writes `start + ν·dt·∇²field` (central differences, second order in h; next to walls by a parabola through the wall's velocity) into the interior values of `target`. The ghosts of `field` must be filled.
///
/// With `start` equal to `field` this is the explicit step: forward Euler, first order in dt.
pub fn explicit<R: Real>(
    grid: &Grid<R>,
    diffusivity_m2_per_s: f64,
    dt_secs: f64,
    start: &Field<R>,
    field: &Field<R>,
    target: &mut Field<R>,
) {
    let strides = grid.strides();
    let weight = grid.spacing_m.map(|h| R::of(diffusivity_m2_per_s * dt_secs) / (h * h));
    let location = field.location;
    let (xs, ys) = (grid.free(location, 0), grid.free(location, 1));
    for_each_plane(grid, grid.free(location, 2), &mut target.data, |k, plane| {
        for j in ys.clone() {
            let at = grid.at([xs.start, j, k]);
            let row = |at: usize| &field.data[at..][..xs.len()];
            let (here, start) = (row(at), &start.data[at..][..xs.len()]);
            let [x, y, z] = strides.map(|s| [row(at - s), row(at + s)]);
            let out = &mut plane[at % strides[2]..][..xs.len()];
            for i in 0..out.len() {
                let twice = here[i] + here[i];
                out[i] = start[i]
                    + weight[0] * (x[0][i] + x[1][i] - twice)
                    + weight[1] * (y[0][i] + y[1][i] - twice)
                    + weight[2] * (z[0][i] + z[1][i] - twice);
            }
        }
    });
    friction::complete(grid, diffusivity_m2_per_s, dt_secs, field, target);
}

/// Backward Euler by Gauss–Seidel sweeps (Zhang §2.3.2, corrected: `a = ν·dt/h²`, and parentheses): relaxes `field` towards the solution of
/// `(1 − ν·dt·∇²)·field = start`, and returns the largest change in the last sweep. `boundaries` applies the boundary conditions after each sweep.
///
/// Stable at any step; the deviation from the implicit solution depends on the number of sweeps.
pub fn gauss_seidel<R: Real>(
    grid: &Grid<R>,
    diffusivity_m2_per_s: f64,
    dt_secs: f64,
    sweeps: u32,
    start: &Field<R>,
    field: &mut Field<R>,
    mut boundaries: impl FnMut(&mut Field<R>),
) -> f64 {
    let strides = grid.strides();
    let inner = grid.spacing_m.map(|h| R::of(diffusivity_m2_per_s * dt_secs) / (h * h));
    let location = field.location;
    let walls = [0, 1, 2].map(|axis| friction::walls(grid, location, axis));
    let weight = |axis: usize, index: usize| {
        let is_next = (walls[axis][0] && index == 0) || (walls[axis][1] && index + 1 == grid.cells[axis]);
        if is_next { R::of(friction::FACTOR) * inner[axis] } else { inner[axis] }
    };
    let mut change = R::zero();
    for _ in 0..sweeps {
        change = R::zero();
        for k in grid.free(location, 2) {
            for j in grid.free(location, 1) {
                for i in grid.free(location, 0) {
                    let at = grid.at([i, j, k]);
                    let weight = [weight(0, i), weight(1, j), weight(2, k)];
                    let per = (R::one() + R::of(2.0) * (weight[0] + weight[1] + weight[2])).recip();
                    let data = &field.data;
                    let around =
                        (0..3).fold(R::zero(), |sum, axis| sum + weight[axis] * (data[at - strides[axis]] + data[at + strides[axis]]));
                    let value = (start.data[at] + around) * per;
                    change = change.max((value - field.data[at]).abs());
                    field.data[at] = value;
                }
            }
        }
        boundaries(field);
    }
    change.wide()
}

/// Diffuses like Crank–Nicolson, second order in dt, but by the L-stable scheme of two stages with γ = 1 + √½ (Alexander, SIAM J. Numer. Anal. 14 (1977)), which
/// leaves the sign of every wave: with the backward Euler step B of length γ·dt, the result is `B·(1 − (√2 − 1)·(B − 1))`. For smooth fields its error is 17 times that of
/// Crank–Nicolson.
///
/// The first stage ends at γ·dt, beyond the step, and the second at its end: `boundaries` applies the conditions at the given multiple of the step.
pub fn keep_signs<R: Real>(
    grid: &Grid<R>,
    diffusivity_m2_per_s: f64,
    dt_secs: f64,
    field: &mut Field<R>,
    start: &mut Field<R>,
    implicit: &mut Implicit,
    mut boundaries: impl FnMut(&mut Field<R>, f64),
) {
    let reach = 1.0 + std::f64::consts::FRAC_1_SQRT_2;
    start.data.copy_from_slice(&field.data);
    boundaries(field, reach);
    implicit.step(grid, diffusivity_m2_per_s, reach * dt_secs, field);
    let back = R::of(std::f64::consts::SQRT_2) - R::one();
    field.data.iter_mut().zip(&start.data).for_each(|(value, &start)| *value = start - back * (*value - start));
    boundaries(field, 1.0);
    implicit.step(grid, diffusivity_m2_per_s, reach * dt_secs, field);
    boundaries(field, 1.0);
}

/// Portion of a step's diffusion: all of it, or the halves before and after the other sub-steps of a second-order scheme (Strang splitting).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Portion {
    /// The whole step.
    Whole,
    /// The first half.
    First,
    /// The second half.
    Second,
}

/// Diffuses `field` over a portion of a step of `dt_secs` (s). `boundaries` applies the boundary conditions to a field as they are at a fraction of
/// the portion: those at its start must be in place, those at its end are afterwards. `even` and `odd` are work arrays.
///
/// Halves of the explicit scheme are midpoint steps (Runge–Kutta 2), with sub-steps within the limit. Those of Crank–Nicolson are Crank–Nicolson steps
/// of half the length with one solve each, since an explicit half before and an implicit half after other sub-steps would not be second order.
/// First-order schemes diffuse entirely in the second half.
#[expect(clippy::too_many_arguments, reason = "a kernel: numbers, a field and its scratch")]
pub fn diffuse<R: Real>(
    scheme: Diffusion,
    portion: Portion,
    grid: &Grid<R>,
    diffusivity_m2_per_s: f64,
    dt_secs: f64,
    field: &mut Field<R>,
    [even, odd]: [&mut Field<R>; 2],
    implicit: Option<&mut Implicit>,
    mut boundaries: impl FnMut(&mut Field<R>, f64),
) {
    if diffusivity_m2_per_s == 0.0 {
        return;
    }
    let substeps = |secs: f64| (secs / stable_dt_secs(grid, diffusivity_m2_per_s)).ceil().max(1.0);
    match (scheme, portion) {
        (Diffusion::Explicit, Portion::Whole) => {
            let n = substeps(dt_secs);
            for number in 1..=n as u32 {
                explicit(grid, diffusivity_m2_per_s, dt_secs / n, field, field, even);
                std::mem::swap(&mut field.data, &mut even.data);
                boundaries(field, f64::from(number) / n);
            }
        }
        (Diffusion::Explicit, _) => {
            let n = substeps(0.5 * dt_secs);
            for number in 0..n as u32 {
                explicit(grid, diffusivity_m2_per_s, 0.25 * dt_secs / n, field, field, even);
                boundaries(even, (f64::from(number) + 0.5) / n);
                explicit(grid, diffusivity_m2_per_s, 0.5 * dt_secs / n, field, even, odd);
                std::mem::swap(&mut field.data, &mut odd.data);
                boundaries(field, f64::from(number + 1) / n);
            }
        }
        (Diffusion::CrankNicolson, portion) => {
            let secs = if portion == Portion::Whole { dt_secs } else { 0.5 * dt_secs };
            if let Some(implicit) = implicit {
                even.data.copy_from_slice(&field.data);
                boundaries(field, 0.5);
                implicit.step(grid, diffusivity_m2_per_s, 0.5 * secs, field);
                // The implicit half ends in mid-step; the explicit half adds the same change again.
                field.data.iter_mut().zip(&even.data).for_each(|(value, &start)| *value = *value + *value - start);
                boundaries(field, 1.0);
            }
        }
        (Diffusion::Implicit | Diffusion::GaussSeidel { .. }, Portion::First) => {}
        (Diffusion::Implicit, _) => {
            if let Some(implicit) = implicit {
                boundaries(field, 1.0);
                implicit.step(grid, diffusivity_m2_per_s, dt_secs, field);
                boundaries(field, 1.0);
            }
        }
        (Diffusion::GaussSeidel { sweeps }, _) => {
            even.data.copy_from_slice(&field.data);
            boundaries(field, 1.0);
            gauss_seidel(grid, diffusivity_m2_per_s, dt_secs, sweeps, even, field, |field| boundaries(field, 1.0));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boundary::BoundaryConditions;
    use crate::{Boundary, Location};

    /// Amplitude of a wave of two cells after diffusion for `dt_secs` that keeps signs, and of the exact solution.
    fn decayed(dt_secs: f64, steps: u32) -> [f64; 2] {
        let grid = Grid { cells: [8, 1, 1], spacing_m: [1.0; 3], boundary: [[Boundary::Wrap; 2]; 3] };
        let walls = BoundaryConditions::new(&grid, Box::new(|_, _| [0.0; 3]));
        let [mut field, mut first] = [(), ()].map(|()| Field::<f64>::zeros(&grid, Location::Face(1)));
        for i in 0..8 {
            field.data[grid.at([i, 0, 0])] = if i % 2 == 0 { 1.0 } else { -1.0 };
        }
        walls.apply_to_component(&mut field);
        let mut implicit = Implicit::new(&grid);
        for _ in 0..steps {
            keep_signs(&grid, 1.0, dt_secs, &mut field, &mut first, &mut implicit, |field, _| walls.apply_to_component(field));
        }
        // Waves of two cells have the eigenvalue −4/h².
        [field.data[grid.at([0, 0, 0])], (-4.0 * dt_secs * f64::from(steps)).exp()]
    }

    #[test]
    fn waves_keep_their_sign_and_decay_with_second_order() {
        for dt_secs in [0.1, 1.0, 1e3, 1e6] {
            let [amplitude, _] = decayed(dt_secs, 1);
            assert!((0.0..1.0).contains(&amplitude), "{amplitude} after {dt_secs} s");
        }
        let errors = [64, 128, 256].map(|steps| {
            let [amplitude, exact] = decayed(0.4 / f64::from(steps), steps);
            (amplitude - exact).abs()
        });
        let orders = [0, 1].map(|at| (errors[at] / errors[at + 1]).log2());
        assert!(orders.iter().all(|order| (1.9..2.1).contains(order)), "{errors:?}: orders {orders:?}");
    }

    /// The only free value between an inflow and an outflow face has the inflow on both sides.
    #[test]
    fn implicit_friction_keeps_a_uniform_wind_through_any_number_of_cells() {
        for cells in 1..5 {
            let boundary = [[Boundary::Inflow, Boundary::Outflow], [Boundary::FreeSlip; 2], [Boundary::Wrap; 2]];
            let grid = Grid { cells: [cells, 4, 3], spacing_m: [1.0; 3], boundary };
            let faces = BoundaryConditions::new(&grid, Box::new(|_, _| [2.0, 0.0, 0.0]));
            let mut field = Field::<f64>::zeros(&grid, Location::Face(0));
            field.data.fill(2.0);
            Implicit::new(&grid).step(&grid, 50.0, 0.1, &mut field);
            faces.apply_to_component(&mut field);
            assert!(field.values(&grid).all(|speed| (speed - 2.0).abs() < 1e-12), "{cells} cells: {:?}", field.data);
        }
    }
}
