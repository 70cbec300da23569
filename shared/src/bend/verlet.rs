//! Explicit Verlet propagation (001 Eqs 2–6) with its stability bound.
//!
//! With λ = 1 − exp(−k·dt) and r = c·dt/h a cell becomes
//! `θ⁺ = (2 − λ)·θ − (1 − λ)·θ⁻ + r²·(Σ neighbours − 4θ) − κ·dt²·θ`, likewise for both components of ω.

use super::{Coefficients, Patch, WaveParams};

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

/// Advances one patch by a sub-step; its ghosts must hold the neighbours' newest values.
pub fn step(patch: &mut Patch, k: &Coefficients) {
    let (side, stride) = (patch.side(), patch.stride());
    let [theta, omega_x, omega_z] = &patch.now;
    let [theta_before, x_before, z_before] = &mut patch.before;
    for j in 1..=side {
        let row = j * stride + 1;
        let r2 = |i: usize| {
            let (x, z) = (omega_x[row + i], omega_z[row + i]);
            let r = k.r0 + k.r_mu * (x * x + z * z).sqrt();
            r * r
        };
        advance_row(theta, theta_before, row, stride, side, k.lambda_theta, k.restoring, r2);
        advance_row(omega_x, x_before, row, stride, side, k.lambda_omega, k.restoring, |_| k.r2_omega);
        advance_row(omega_z, z_before, row, stride, side, k.lambda_omega, k.restoring, |_| k.r2_omega);
    }
    std::mem::swap(&mut patch.now, &mut patch.before);
}

/// Writes the next values of one row over the values before it.
#[allow(clippy::too_many_arguments, reason = "one row of one channel: its data and its four numbers")]
#[inline(always)]
fn advance_row(
    now: &[f32],
    before: &mut [f32],
    row: usize,
    stride: usize,
    side: usize,
    lambda: f32,
    restoring: f32,
    r2: impl Fn(usize) -> f32,
) {
    let (keep, memory) = (2.0 - lambda - restoring, 1.0 - lambda);
    let before = &mut before[row..row + side];
    let center = &now[row..row + side];
    let west = &now[row - 1..row - 1 + side];
    let east = &now[row + 1..row + 1 + side];
    let north = &now[row - stride..row - stride + side];
    let south = &now[row + stride..row + stride + side];
    for i in 0..side {
        let laplacian = (west[i] + east[i]) + (north[i] + south[i]) - 4.0 * center[i];
        before[i] = keep * center[i] - memory * before[i] + r2(i) * laplacian;
    }
}
