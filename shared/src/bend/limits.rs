//! Stability limits of the explicit schemes.

use super::{Coefficients, Damping, WaveParams};

/// Largest number of sub-steps in a step.
pub const SUBSTEPS_LIMIT: u32 = 4096;

/// Fraction of the Courant limit that [`substeps`] uses; the rest covers the growth of |ω| within a step.
const SAFETY: f32 = 0.95;
/// The same for θ whose speed varies by Eq. (4) with its momentum kept. A sub-step keeps the energy with the fraction `1 − fraction²` of the checkerboard's
/// bend, and more of that of longer waves; where c changes, so does that fraction, here to at least 3/4. Nearer the limit a speed that oscillates within a
/// few sub-steps drives the checkerboard up. Chosen by trial, after 0.95, 0.7 and 0.6 had failed in some of the stiff random draws of `tests/bend/random.rs`; see
/// there for draws that had no part in the choice.
const VARYING_SAFETY: f32 = 0.5;

/// Largest Courant number for damping λ and restoring term `κ·dt²`: `r ≤ √((4 − 2λ − κ·dt²)/8)`.
///
/// Derived from the checkerboard mode, the first to fail: its step has the polynomial `g² − (2 − λ − 8r² − κdt²)·g + (1 − λ)`, whose roots stay
/// within the unit circle iff `8r² + κdt² ≤ 4 − 2λ`. For κ = 0 this is `√((2 − λ)/4)`: 0.707 undamped, 0.5 at λ = 1; more damping makes the scheme
/// less stable. Zero when no step of this length is stable. Where the wave speed varies in space, the largest counts: the scheme's matrix is similar
/// to a symmetric one whose norm it bounds.
pub fn courant_limit(lambda: f32, restoring: f32) -> f32 {
    ((4.0 - 2.0 * lambda - restoring) / 8.0).max(0.0).sqrt()
}

/// Courant number of a sub-step relative to its limit: the scheme is stable up to 1.
///
/// Where θ keeps its momentum, its restoring term grows with the speed, `κ·(c/c₀)²`, so that the limit is `r ≤ √((4 − 2λ)/(8 + κ·(h/c₀)²))`.
pub fn courant_fraction(k: &Coefficients, omega_max_rad_per_s: f32) -> f32 {
    let [theta, omega] = fractions(k, omega_max_rad_per_s);
    // Not `max`, which would drop NaN.
    if theta >= omega { theta } else { omega }
}

/// The Courant numbers of θ and ω relative to their limits.
fn fractions(k: &Coefficients, omega_max_rad_per_s: f32) -> [f32; 2] {
    let r = k.r0 + k.r_mu * omega_max_rad_per_s;
    let theta = if k.keeps_momentum() {
        r * ((8.0 + k.stiffness) / (4.0 - 2.0 * k.lambda_theta)).sqrt()
    } else {
        r / courant_limit(k.lambda_theta, k.restoring[0])
    };
    [theta, k.r2_omega.sqrt() / courant_limit(k.lambda_omega, k.restoring[1])]
}

/// Smallest number of equal sub-steps of `dt_secs` that keeps every cell within the limit as long as no bending velocity exceeds
/// `omega_max_rad_per_s`; `None` if that takes more than [`SUBSTEPS_LIMIT`].
pub fn substeps(waves: &[WaveParams], cell_m: f32, dt_secs: f32, omega_max_rad_per_s: f32, damping: Damping) -> Option<u32> {
    let fits = |count: u32| {
        waves.iter().all(|params| {
            let k = Coefficients::new(params, cell_m, dt_secs / count as f32, damping);
            let [theta, omega] = fractions(&k, omega_max_rad_per_s);
            theta <= (if k.keeps_momentum() { VARYING_SAFETY } else { SAFETY }) && omega <= SAFETY
        })
    };
    // All terms shrink with the step, so doubling and then bisecting finds the smallest count.
    let mut enough = 1;
    while !fits(enough) {
        enough *= 2;
        if enough > SUBSTEPS_LIMIT {
            return None;
        }
    }
    let mut too_few = enough / 2;
    while enough - too_few > 1 {
        let middle = (enough + too_few) / 2;
        if fits(middle) { enough = middle } else { too_few = middle }
    }
    Some(enough)
}
