//! Constants of the wave equations, and the coefficients of one sub-step.

use serde::{Deserialize, Serialize};

/// Constants of the wave equations, Chen & Johan Eqs (2)–(6): speeds in m/s and damping as a rate in 1/s, so that results do not depend on the time
/// step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct WaveParams {
    /// Base wave speed c₀ of the bending angle θ (m/s), Chen & Johan Eq. (4). Default 1, allowed 0..=50; Chen & Johan use 1..=10.
    pub c0_m_per_s: f32,
    /// Growth μ of that speed with the bending velocity (m/rad), Chen & Johan Eq. (4). Default 0.05, allowed 0..=10; Chen & Johan use 0..=1.5.
    pub mu_m_per_rad: f32,
    /// Wave speed c_ω of the bending velocity ω (m/s), Chen & Johan Eq. (3). Default 1, allowed 0..=50.
    pub c_omega_m_per_s: f32,
    /// Damping rate k_θ of θ (1/s): Chen & Johan's λ_θ = 1 − exp(−k_θ·dt). Default 6, allowed 0..=200.
    pub theta_damping_per_s: f32,
    /// Damping rate k_ω of ω (1/s). Default 6, allowed 0..=200.
    pub omega_damping_per_s: f32,
    /// Restoring rate κ (1/s²): adds −κ·θ to Eq. (2) and −κ·ω to Eq. (3), so that bent grass rises even where no wave carries the bend away. The slow
    /// time constant is k/κ; stiffer plants also droop less. Default 1.2 (tracks rise in about 5 s), allowed 0..=10000; Chen & Johan have 0.
    pub stiffness_per_s2: f32,
}

impl Default for WaveParams {
    fn default() -> Self {
        Self {
            c0_m_per_s: 1.0,
            mu_m_per_rad: 0.05,
            c_omega_m_per_s: 1.0,
            theta_damping_per_s: 6.0,
            omega_damping_per_s: 6.0,
            stiffness_per_s2: 1.2,
        }
    }
}

/// Discretisation of the damping rate k in a sub-step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Damping {
    /// Chen & Johan Eqs (5)–(6) as published, with λ = 1 − exp(−k·dt): the force counts in full, and a wave that slows down keeps its motion.
    /// First order in time.
    Plain,
    /// The velocity decays by 1 − λ and gains the force times (1 − exp(−k·dt))/k, which is exact under a steady force. Where the wave speed c of θ changes
    /// by Eq. (4), a wave keeps its momentum θ'/c instead of θ', so that no change of speed adds energy. Second order in time.
    Exact,
}

/// Coefficients of a sub-step of `dt` seconds. φ is the fraction of the force that counts: 1 for [`Damping::Plain`], λ/(k·dt) for
/// [`Damping::Exact`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// λ_θ = 1 − exp(−k_θ·dt).
    pub lambda_theta: f32,
    /// λ_ω = 1 − exp(−k_ω·dt).
    pub lambda_omega: f32,
    /// √φ·c₀·dt/h: Courant number of θ at rest. With [`Damping::Exact`] and μ > 0 at least 10⁻⁵: θ − θ⁻ couldn't hold a smaller momentum in f32.
    pub r0: f32,
    /// √φ·μ·dt/h (s/rad): increase of that Courant number per rad/s of bending velocity.
    pub r_mu: f32,
    /// φ·(c_ω·dt/h)².
    pub r2_omega: f32,
    /// φ·κ·dt², for θ and for ω.
    pub restoring: [f32; 2],
    /// κ·(h/c₀)², with the c₀ of `r0`: the restoring term of θ relative to the square of its Courant number, where its wave speed changes.
    pub stiffness: f32,
    /// Whether θ keeps its motion θ', not its momentum θ'/c, where its wave speed changes by Eq. (4).
    pub keeps_motion: bool,
}

impl Coefficients {
    /// Coefficients of a sub-step of `dt_secs` on cells of side `cell_m`.
    pub fn new(params: &WaveParams, cell_m: f32, dt_secs: f32, damping: Damping) -> Self {
        let theta = Decay::new(params.theta_damping_per_s, dt_secs, damping);
        let omega = Decay::new(params.omega_damping_per_s, dt_secs, damping);
        let courant =
            |speed: f32, decay: &Decay| (decay.force_fraction.sqrt() * f64::from(speed) * f64::from(dt_secs) / f64::from(cell_m)) as f32;
        let r_omega = courant(params.c_omega_m_per_s, &omega);
        let restoring = |decay: &Decay| (decay.force_fraction * f64::from(params.stiffness_per_s2) * f64::from(dt_secs).powi(2)) as f32;
        let (r0, r_mu) = (courant(params.c0_m_per_s, &theta), courant(params.mu_m_per_rad, &theta));
        let keeps_motion = damping == Damping::Plain;
        let r0 = if keeps_motion || r_mu == 0.0 { r0 } else { r0.max(SLOWEST) };
        Self {
            lambda_theta: theta.lambda as f32,
            lambda_omega: omega.lambda as f32,
            r0,
            r_mu,
            r2_omega: r_omega * r_omega,
            restoring: [restoring(&theta), restoring(&omega)],
            stiffness: restoring(&theta) / (r0 * r0),
            keeps_motion,
        }
    }

    /// Whether the wave speed of θ follows the bend with its momentum kept.
    pub(super) fn keeps_momentum(&self) -> bool {
        self.r_mu > 0.0 && !self.keeps_motion
    }
}

/// Smallest Courant number at rest of θ whose speed varies.
const SLOWEST: f32 = 1e-5;

/// λ and φ in f64, so that small rates keep their digits.
struct Decay {
    lambda: f64,
    force_fraction: f64,
}

impl Decay {
    fn new(rate_per_s: f32, dt_secs: f32, damping: Damping) -> Self {
        let exponent = f64::from(rate_per_s) * f64::from(dt_secs);
        let lambda = -libm::expm1(-exponent);
        let force_fraction = if damping == Damping::Plain || exponent == 0.0 { 1.0 } else { lambda / exponent };
        Self { lambda, force_fraction }
    }
}
