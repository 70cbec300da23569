//! Explicit Verlet propagation (001 Eqs 2–6) with its stability bound.
//!
//! With λ = 1 − exp(−k·dt) and r = c·dt/h a cell becomes
//! `θ⁺ = (2 − λ)·θ − (1 − λ)·θ⁻ + r²·(Σ neighbours − 4θ) − κ·dt²·θ`, likewise for both components of ω.

use super::patch::LargestOf;
use super::{CHANNELS, Coefficients, Extremes, Force, Patch, WaveParams};

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
    let mut largest = LargestOf::default();
    for j in 0..patch.side() {
        advance_row(patch, k, j, &mut largest, |_| ());
    }
    std::mem::swap(&mut patch.now, &mut patch.before);
    largest.extremes()
}

/// [`step`] with a force, whose values are added to the new state.
pub fn step_forced(patch: &mut Patch, k: &Coefficients, force: &Force) -> Extremes {
    let mut forces = vec![0.0; patch.side()];
    let mut largest = LargestOf::default();
    for j in 0..patch.side() {
        advance_row(patch, k, j, &mut largest, |next| {
            for (channel, next) in next.iter_mut().enumerate() {
                force.row(channel, j, &mut forces);
                next.iter_mut().zip(&forces).for_each(|(next, force)| *next += force);
            }
        });
    }
    std::mem::swap(&mut patch.now, &mut patch.before);
    largest.extremes()
}

/// Writes the next values of row `j` over the values before it, and lets `then` change them.
#[inline(always)]
fn advance_row(patch: &mut Patch, k: &Coefficients, j: usize, largest: &mut LargestOf, mut then: impl FnMut(&mut [&mut [f32]; CHANNELS])) {
    let (side, row) = (patch.side(), patch.at(0, j));
    let [theta, omega_x, omega_z] = patch.now.each_ref().map(|now| Stencil::new(now, row, side));
    let mut next = patch.before.each_mut().map(|before| &mut before[row..row + side]);
    let (x, z) = (omega_x.center, omega_z.center);
    let r2 = |i: usize| {
        let r = k.r0 + k.r_mu * (x[i] * x[i] + z[i] * z[i]).sqrt();
        r * r
    };
    theta.advance(next[0], k.lambda_theta, k.restoring, r2);
    omega_x.advance(next[1], k.lambda_omega, k.restoring, |_| k.r2_omega);
    omega_z.advance(next[2], k.lambda_omega, k.restoring, |_| k.r2_omega);
    then(&mut next);
    largest.add(next[0], next[1], next[2]);
}

/// A row of cells with the rows around it.
struct Stencil<'a> {
    center: &'a [f32],
    west: &'a [f32],
    east: &'a [f32],
    north: &'a [f32],
    south: &'a [f32],
}

impl<'a> Stencil<'a> {
    fn new(now: &'a [f32], row: usize, side: usize) -> Self {
        let stride = side + 2;
        let at = |start: usize| &now[start..start + side];
        Self { center: at(row), west: at(row - 1), east: at(row + 1), north: at(row - stride), south: at(row + stride) }
    }

    /// Turns the values before into the next ones.
    #[inline(always)]
    fn advance(&self, before: &mut [f32], lambda: f32, restoring: f32, r2: impl Fn(usize) -> f32) {
        let side = before.len();
        let (keep, memory) = (2.0 - lambda - restoring, 1.0 - lambda);
        let [center, west, east, north, south] = [self.center, self.west, self.east, self.north, self.south].map(|row| &row[..side]);
        for i in 0..side {
            let laplacian = (west[i] + east[i]) + (north[i] + south[i]) - 4.0 * center[i];
            before[i] = keep * center[i] - memory * before[i] + r2(i) * laplacian;
        }
    }
}
