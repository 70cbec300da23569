//! Explicit Verlet propagation (001 Eqs 2–6) with its stability bound.
//!
//! With λ = 1 − exp(−k·dt) and r = c·dt/h a cell becomes
//! `θ⁺ = (2 − λ)·θ − (1 − λ)·θ⁻ + r²·(Σ neighbours − 4θ) − κ·dt²·θ`, likewise for both components of ω. When dt changes,
//! θ⁻ is moved first, to keep (θ − θ⁻)/dt.

use super::extremes::LargestOf;
use super::{CHANNELS, Coefficients, Extremes, Patch, WaveParams};
use multiversion::multiversion;

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

/// Advances one patch by a sub-step; its ghosts must hold the neighbours' newest values. Returns the extremes of the new
/// state.
pub fn step(patch: &mut Patch, k: &Coefficients) -> Extremes {
    advance(patch, k, &mut Alone)
}

/// What happens at a patch's western and eastern ends while its rows advance one by one. Done row by row, it finds the cells in the
/// cache.
pub(super) trait Seams {
    /// Before row `j` advances: its first own cell lies at `row`.
    fn fill(&mut self, j: usize, row: usize, now: &mut [Vec<f32>; CHANNELS]);
    /// After it: the new values.
    fn publish(&mut self, j: usize, next: [&[f32]; CHANNELS]);
}

/// A patch whose ghosts are filled already and whom nobody reads.
struct Alone;

impl Seams for Alone {
    fn fill(&mut self, _: usize, _: usize, _: &mut [Vec<f32>; CHANNELS]) {}
    fn publish(&mut self, _: usize, _: [&[f32]; CHANNELS]) {}
}

/// Advances row by row, in place over the state before.
#[inline(always)]
pub(super) fn advance(patch: &mut Patch, k: &Coefficients, seams: &mut impl Seams) -> Extremes {
    patch.retime(k.dt_secs);
    let side = patch.side();
    let mut largest = LargestOf::default();
    for j in 0..side {
        let row = patch.at(0, j);
        seams.fill(j, row, &mut patch.now);
        let [theta, x, z] = &patch.now;
        let [theta_next, x_next, z_next] = &mut patch.before;
        let theta_next = &mut theta_next[row..row + side];
        let (x_next, z_next) = (&mut x_next[row..row + side], &mut z_next[row..row + side]);
        advance_theta(&Stencil::new(theta, row, side), &x[row..row + side], &z[row..row + side], theta_next, k);
        advance_omega(&Stencil::new(x, row, side), x_next, k);
        advance_omega(&Stencil::new(z, row, side), z_next, k);
        largest.add(theta_next, x_next, z_next);
        seams.publish(j, [theta_next, x_next, z_next]);
    }
    std::mem::swap(&mut patch.now, &mut patch.before);
    largest.extremes()
}

/// A row of a channel with the cells around it.
struct Stencil<'a> {
    center: &'a [f32],
    west: &'a [f32],
    east: &'a [f32],
    north: &'a [f32],
    south: &'a [f32],
}

impl<'a> Stencil<'a> {
    #[inline(always)]
    fn new(now: &'a [f32], row: usize, side: usize) -> Self {
        let (north, south) = (row - (side + 2), row + (side + 2));
        Self {
            center: &now[row..row + side],
            west: &now[row - 1..row - 1 + side],
            east: &now[row + 1..row + 1 + side],
            north: &now[north..north + side],
            south: &now[south..south + side],
        }
    }
}

// Kept apart from the loop over rows: inlined into it, the compiler loses sight of which slices cannot overlap.
#[multiversion(targets("x86_64+avx2"))]
fn advance_theta(now: &Stencil, x: &[f32], z: &[f32], next: &mut [f32], k: &Coefficients) {
    let side = next.len();
    let (keep, memory) = (2.0 - k.lambda_theta - k.restoring, 1.0 - k.lambda_theta);
    let (center, west, east) = (&now.center[..side], &now.west[..side], &now.east[..side]);
    let (north, south, x, z) = (&now.north[..side], &now.south[..side], &x[..side], &z[..side]);
    for i in 0..side {
        let r = k.r0 + k.r_mu * (x[i] * x[i] + z[i] * z[i]).sqrt();
        let laplacian = (west[i] + east[i]) + (north[i] + south[i]) - 4.0 * center[i];
        next[i] = keep * center[i] - memory * next[i] + r * r * laplacian;
    }
}

#[multiversion(targets("x86_64+avx2"))]
fn advance_omega(now: &Stencil, next: &mut [f32], k: &Coefficients) {
    let side = next.len();
    let (keep, memory, r2) = (2.0 - k.lambda_omega - k.restoring, 1.0 - k.lambda_omega, k.r2_omega);
    let (center, west, east) = (&now.center[..side], &now.west[..side], &now.east[..side]);
    let (north, south) = (&now.north[..side], &now.south[..side]);
    for i in 0..side {
        let laplacian = (west[i] + east[i]) + (north[i] + south[i]) - 4.0 * center[i];
        next[i] = keep * center[i] - memory * next[i] + r2 * laplacian;
    }
}
