//! Diffusion, four ways.
//!
//! Air on a grid of metres has ν·dt/h² far below the limit of the explicit step, so that one sweep of seven reads a cell, a small part of the cost of an
//! implicit solve, is the rule.

mod implicit;

pub use implicit::Implicit;

use super::field::for_each_plane;
use super::{Diffusion, Field, Grid, Real};

/// Longest step (s) that [`explicit`] bears: `1 / (2·ν·Σ 1/h²)`, which is `a = ν·dt/h² = 1/6` on cubes. Above it the checkerboard mode grows.
///
/// Infinite for a diffusivity of 0.
pub fn stable_dt_secs<R: Real>(grid: &Grid<R>, diffusivity_m2_per_s: f64) -> f64 {
    let curvature: f64 = grid.spacing_m.iter().map(|h| (h.wide() * h.wide()).recip()).sum();
    (2.0 * diffusivity_m2_per_s * curvature).recip()
}

/// Writes `start + ν·dt·∇²field` (central differences, second order in h) into the values of `target` that the flow decides. The ghosts of `field` must be filled.
///
/// With `start` the field itself this is the explicit step: forward Euler, first order in dt.
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
    let place = field.place;
    let (xs, ys) = (grid.free(place, 0), grid.free(place, 1));
    for_each_plane(grid, grid.free(place, 2), &mut target.data, |k, plane| {
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
}

/// Backward Euler by Gauss–Seidel sweeps, as 000 §2.3.2 has it (with `a = ν·dt/h²` and its parentheses set right): relaxes `field` towards the solution of
/// `(1 − ν·dt·∇²)·field = start`, and returns the largest change of the last sweep. `close` fills in the boundary's share after each sweep.
///
/// Stable at any step; how far it is from the implicit solution depends on the number of sweeps.
pub fn gauss_seidel<R: Real>(
    grid: &Grid<R>,
    diffusivity_m2_per_s: f64,
    dt_secs: f64,
    sweeps: u32,
    start: &Field<R>,
    field: &mut Field<R>,
    close: impl Fn(&mut Field<R>),
) -> f64 {
    let strides = grid.strides();
    let weight = grid.spacing_m.map(|h| R::of(diffusivity_m2_per_s * dt_secs) / (h * h));
    let two = R::of(2.0);
    let per = (R::one() + two * (weight[0] + weight[1] + weight[2])).recip();
    let place = field.place;
    let mut change = R::zero();
    for _ in 0..sweeps {
        change = R::zero();
        for k in grid.free(place, 2) {
            for j in grid.free(place, 1) {
                for i in grid.free(place, 0) {
                    let at = grid.at([i, j, k]);
                    let data = &field.data;
                    let around =
                        (0..3).fold(R::zero(), |sum, axis| sum + weight[axis] * (data[at - strides[axis]] + data[at + strides[axis]]));
                    let value = (start.data[at] + around) * per;
                    change = change.max((value - field.data[at]).abs());
                    field.data[at] = value;
                }
            }
        }
        close(field);
    }
    change.wide()
}

/// Which part of a step's friction: all of it, or what comes before and after the rest of a step that is second order in dt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Portion {
    /// All.
    Whole,
    /// The half before.
    First,
    /// The half after.
    Second,
}

/// Spreads `field`, whose ghosts are filled, by a portion of a step of `dt_secs` (s); its ghosts are filled again after. `close` fills in the boundary's share
/// of a field, `scratch` is room for two.
///
/// Halves of the explicit scheme are midpoint steps (Runge–Kutta 2), each cut into parts of its limit; those of Crank–Nicolson are Crank–Nicolson steps of
/// half the length, with a solve each: an explicit half before the rest of a step and an implicit one after would cancel only if nothing came between them. The
/// first-order schemes do all in the second half.
#[allow(clippy::too_many_arguments, reason = "a kernel: numbers, a field and its scratch")]
pub fn spread<R: Real>(
    scheme: Diffusion,
    portion: Portion,
    grid: &Grid<R>,
    diffusivity_m2_per_s: f64,
    dt_secs: f64,
    field: &mut Field<R>,
    [even, odd]: [&mut Field<R>; 2],
    implicit: Option<&mut Implicit>,
    close: impl Fn(&mut Field<R>),
) {
    if diffusivity_m2_per_s == 0.0 {
        return;
    }
    let parts = |secs: f64| (secs / stable_dt_secs(grid, diffusivity_m2_per_s)).ceil().max(1.0);
    let mut euler = |field: &mut Field<R>, secs: f64| {
        explicit(grid, diffusivity_m2_per_s, secs, field, field, even);
        std::mem::swap(&mut field.data, &mut even.data);
        close(field);
    };
    match (scheme, portion) {
        (Diffusion::Explicit, Portion::Whole) => {
            let parts = parts(dt_secs);
            (0..parts as u32).for_each(|_| euler(field, dt_secs / parts));
        }
        (Diffusion::Explicit, _) => {
            let parts = parts(0.5 * dt_secs);
            let secs = 0.5 * dt_secs / parts;
            for _ in 0..parts as u32 {
                explicit(grid, diffusivity_m2_per_s, 0.5 * secs, field, field, even);
                close(even);
                explicit(grid, diffusivity_m2_per_s, secs, field, even, odd);
                std::mem::swap(&mut field.data, &mut odd.data);
                close(field);
            }
        }
        (Diffusion::CrankNicolson, portion) => {
            let secs = if portion == Portion::Whole { dt_secs } else { 0.5 * dt_secs };
            if let Some(implicit) = implicit {
                even.data.copy_from_slice(&field.data);
                implicit.step(grid, diffusivity_m2_per_s, 0.5 * secs, field);
                // The implicit half leads to the middle of the step, which the explicit half goes on from as far again.
                field.data.iter_mut().zip(&even.data).for_each(|(value, &start)| *value = *value + *value - start);
                close(field);
            }
        }
        (Diffusion::Implicit | Diffusion::GaussSeidel { .. }, Portion::First) => {}
        (Diffusion::Implicit, _) => {
            if let Some(implicit) = implicit {
                implicit.step(grid, diffusivity_m2_per_s, dt_secs, field);
                close(field);
            }
        }
        (Diffusion::GaussSeidel { sweeps }, _) => {
            even.data.copy_from_slice(&field.data);
            gauss_seidel(grid, diffusivity_m2_per_s, dt_secs, sweeps, even, field, close);
        }
    }
}
