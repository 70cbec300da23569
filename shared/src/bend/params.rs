//! Constants of the wave equations, and what one sub-step makes of them.

use crate::scene::Grass;

/// Constants of 001 Eqs (2)–(6) in units that do not depend on the time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaveParams {
    /// Base speed of θ, c₀ (m/s).
    pub c0_m_per_s: f32,
    /// Growth of that speed with the bending speed, μ (m/rad), Eq. (4).
    pub mu_m_per_rad: f32,
    /// Speed of ω, c_ω (m/s).
    pub c_omega_m_per_s: f32,
    /// Damping rate of θ (1/s).
    pub theta_damping_per_s: f32,
    /// Damping rate of ω (1/s).
    pub omega_damping_per_s: f32,
    /// Restoring rate κ (1/s²).
    pub stiffness_per_s2: f32,
}

impl From<&Grass> for WaveParams {
    fn from(grass: &Grass) -> Self {
        Self {
            c0_m_per_s: grass.c0_m_per_s,
            mu_m_per_rad: grass.mu_m_per_rad,
            c_omega_m_per_s: grass.c_omega_m_per_s,
            theta_damping_per_s: grass.theta_damping_per_s,
            omega_damping_per_s: grass.omega_damping_per_s,
            stiffness_per_s2: grass.stiffness_per_s2,
        }
    }
}

/// How a sub-step takes the damping rate k.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Damping {
    /// 001 Eqs (5)–(6) as they stand, with λ = 1 − exp(−k·dt): the force counts in full, and a wave that slows down keeps its motion. First
    /// order in time.
    Plain,
    /// The velocity decays by 1 − λ and gains the force times (1 − exp(−k·dt))/k, as it would exactly under a steady force.
    /// Second order in time. A wave that slows down by Eq. (4) loses the motion that it can no longer carry, so that no change of its speed adds
    /// energy.
    Exact,
}

/// What a sub-step of `dt` seconds multiplies with. Speeds and stiffness hold the root or the whole of the share φ in which the force
/// counts: 1 for [`Damping::Plain`], λ/(k·dt) for [`Damping::Exact`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// λ_θ = 1 − exp(−k_θ·dt).
    pub lambda_theta: f32,
    /// λ_ω = 1 − exp(−k_ω·dt).
    pub lambda_omega: f32,
    /// √φ·c₀·dt/h: Courant number of θ at rest.
    pub r0: f32,
    /// √φ·μ·dt/h (s/rad): Courant number added for each rad/s of bending speed.
    pub r_mu: f32,
    /// φ·(c_ω·dt/h)².
    pub r2_omega: f32,
    /// φ·κ·dt², of θ and of ω.
    pub restoring: [f32; 2],
    /// Whether θ keeps all its motion where its speed falls by Eq. (4).
    pub keeps_motion: bool,
}

impl Coefficients {
    /// Coefficients of a sub-step of `dt_secs` on cells of side `cell_m`.
    pub fn new(params: &WaveParams, cell_m: f32, dt_secs: f32, damping: Damping) -> Self {
        let theta = Decay::new(params.theta_damping_per_s, dt_secs, damping);
        let omega = Decay::new(params.omega_damping_per_s, dt_secs, damping);
        let courant = |speed: f32, decay: &Decay| (decay.share.sqrt() * f64::from(speed) * f64::from(dt_secs) / f64::from(cell_m)) as f32;
        let r_omega = courant(params.c_omega_m_per_s, &omega);
        let restoring = |decay: &Decay| (decay.share * f64::from(params.stiffness_per_s2) * f64::from(dt_secs).powi(2)) as f32;
        Self {
            lambda_theta: theta.lambda as f32,
            lambda_omega: omega.lambda as f32,
            r0: courant(params.c0_m_per_s, &theta),
            r_mu: courant(params.mu_m_per_rad, &theta),
            r2_omega: r_omega * r_omega,
            restoring: [restoring(&theta), restoring(&omega)],
            keeps_motion: damping == Damping::Plain,
        }
    }
}

/// λ and φ, in f64 so that small rates keep their digits.
struct Decay {
    lambda: f64,
    share: f64,
}

impl Decay {
    fn new(rate_per_s: f32, dt_secs: f32, damping: Damping) -> Self {
        let exponent = f64::from(rate_per_s) * f64::from(dt_secs);
        let lambda = -f64::exp_m1(-exponent);
        let share = if damping == Damping::Plain || exponent == 0.0 { 1.0 } else { lambda / exponent };
        Self { lambda, share }
    }
}
