//! Explicit Verlet propagation (001 Eqs 2–6) with its stability bound.
//!
//! With λ = 1 − exp(−k·dt) and r = c·dt/h a cell becomes
//! `θ⁺ = (2 − λ)·θ − (1 − λ)·θ⁻ + r²·(Σ neighbours − 4θ) − κ·dt²·θ`, likewise for both components of ω.

use super::extremes::LargestOf;
use super::{Coefficients, Extremes, Force, Patch, WaveParams};

/// Largest Courant number `c·dt/h` for damping λ and restoring term `κ·dt²`: `r ≤ √((4 − 2λ − κ·dt²)/8)`.
///
/// Derived from the checkerboard mode, the first to fail: its step has the polynomial `g² − (2 − λ − 8r² − κdt²)·g + (1 − λ)`,
/// whose roots stay within the unit circle iff `8r² + κdt² ≤ 4 − 2λ`. For κ = 0 this is `√((2 − λ)/4)`: 0.707 undamped, 0.5 at
/// λ = 1; more damping makes the scheme less stable. Zero when no step of this length is stable.
pub fn courant_limit(lambda: f32, restoring: f32) -> f32 {
    ((4.0 - 2.0 * lambda - restoring) / 8.0).max(0.0).sqrt()
}

/// Share of the Courant limit that [`substeps`] uses; the rest covers the growth of |ω| within a step.
const SAFETY: f32 = 0.95;

/// Least number of equal sub-steps of `dt_secs` that keeps every cell within [`courant_limit`], when no bending speed
/// exceeds `omega_max_rad_per_s`.
pub fn substeps(params: &WaveParams, cell_m: f32, dt_secs: f32, omega_max_rad_per_s: f32) -> u32 {
    let fits = |count: u32| {
        let k = Coefficients::new(params, cell_m, dt_secs / count as f32);
        let r_theta = k.r0 + k.r_mu * omega_max_rad_per_s;
        r_theta <= SAFETY * courant_limit(k.lambda_theta, k.restoring)
            && k.r2_omega.sqrt() <= SAFETY * courant_limit(k.lambda_omega, k.restoring)
    };
    // λ and κ·dt² both shrink with the step, so doubling then bisecting finds the least count.
    let mut enough = 1;
    while !fits(enough) {
        enough *= 2;
    }
    let mut too_few = enough / 2;
    while enough - too_few > 1 {
        let middle = (enough + too_few) / 2;
        if fits(middle) { enough = middle } else { too_few = middle }
    }
    enough
}

/// Largest stable step (s): `dt_secs` over [`substeps`].
pub fn stable_dt(params: &WaveParams, cell_m: f32, dt_secs: f32, omega_max_rad_per_s: f32) -> f32 {
    dt_secs / substeps(params, cell_m, dt_secs, omega_max_rad_per_s) as f32
}

/// Advances one patch by a sub-step; its ghosts must hold the neighbours' newest values. Returns the extremes of the new
/// state.
pub fn step(patch: &mut Patch, k: &Coefficients) -> Extremes {
    advance(patch, k, |_, _, _| ())
}

/// [`step`] with a force, whose values are added to the new state.
pub fn step_forced(patch: &mut Patch, k: &Coefficients, force: &Force) -> Extremes {
    advance(patch, k, |channel, j, next| force.add_row(channel, j, next))
}

/// Advances row by row, in place over the state before; `then` may change the next values of a channel's row.
#[inline(always)]
fn advance(patch: &mut Patch, k: &Coefficients, then: impl Fn(usize, usize, &mut [f32])) -> Extremes {
    let (side, stride) = (patch.side(), patch.stride());
    let mut largest = LargestOf::default();
    for j in 0..side {
        let row = patch.at(0, j);
        let [theta, x, z] = &patch.now;
        let [theta_next, x_next, z_next] = &mut patch.before;
        let theta_next = &mut theta_next[row..row + side];
        let (x_next, z_next) = (&mut x_next[row..row + side], &mut z_next[row..row + side]);
        advance_theta(theta, &x[row..row + side], &z[row..row + side], theta_next, row, stride, k);
        advance_omega(x, x_next, row, stride, k);
        advance_omega(z, z_next, row, stride, k);
        then(0, j, theta_next);
        then(1, j, x_next);
        then(2, j, z_next);
        largest.add(theta_next, x_next, z_next);
    }
    std::mem::swap(&mut patch.now, &mut patch.before);
    largest.extremes()
}

#[inline(never)]
fn advance_theta(now: &[f32], x: &[f32], z: &[f32], next: &mut [f32], row: usize, stride: usize, k: &Coefficients) {
    let side = next.len();
    let (keep, memory) = (2.0 - k.lambda_theta - k.restoring, 1.0 - k.lambda_theta);
    let (center, west, east) = (&now[row..row + side], &now[row - 1..row - 1 + side], &now[row + 1..row + 1 + side]);
    let (north, south) = (&now[row - stride..row - stride + side], &now[row + stride..row + stride + side]);
    let (x, z) = (&x[..side], &z[..side]);
    for i in 0..side {
        let r = k.r0 + k.r_mu * (x[i] * x[i] + z[i] * z[i]).sqrt();
        let laplacian = (west[i] + east[i]) + (north[i] + south[i]) - 4.0 * center[i];
        next[i] = keep * center[i] - memory * next[i] + r * r * laplacian;
    }
}

#[inline(never)]
fn advance_omega(now: &[f32], next: &mut [f32], row: usize, stride: usize, k: &Coefficients) {
    let side = next.len();
    let (keep, memory, r2) = (2.0 - k.lambda_omega - k.restoring, 1.0 - k.lambda_omega, k.r2_omega);
    let (center, west, east) = (&now[row..row + side], &now[row - 1..row - 1 + side], &now[row + 1..row + 1 + side]);
    let (north, south) = (&now[row - stride..row - stride + side], &now[row + stride..row + stride + side]);
    for i in 0..side {
        let laplacian = (west[i] + east[i]) + (north[i] + south[i]) - 4.0 * center[i];
        next[i] = keep * center[i] - memory * next[i] + r2 * laplacian;
    }
}
