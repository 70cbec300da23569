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

/// What a sub-step of `dt` seconds multiplies with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// Length of the sub-step (s).
    pub dt_secs: f32,
    /// λ_θ = 1 − exp(−k_θ·dt).
    pub lambda_theta: f32,
    /// λ_ω = 1 − exp(−k_ω·dt).
    pub lambda_omega: f32,
    /// c₀·dt/h: Courant number of θ at rest.
    pub r0: f32,
    /// μ·dt/h (s/rad): Courant number added for each rad/s of bending speed.
    pub r_mu: f32,
    /// (c_ω·dt/h)².
    pub r2_omega: f32,
    /// κ·dt².
    pub restoring: f32,
}

impl Coefficients {
    /// Coefficients of a sub-step of `dt_secs` on cells of side `cell_m`.
    pub fn new(params: &WaveParams, cell_m: f32, dt_secs: f32) -> Self {
        let r_omega = params.c_omega_m_per_s * dt_secs / cell_m;
        Self {
            dt_secs,
            lambda_theta: damping(params.theta_damping_per_s, dt_secs),
            lambda_omega: damping(params.omega_damping_per_s, dt_secs),
            r0: params.c0_m_per_s * dt_secs / cell_m,
            r_mu: params.mu_m_per_rad * dt_secs / cell_m,
            r2_omega: r_omega * r_omega,
            restoring: params.stiffness_per_s2 * dt_secs * dt_secs,
        }
    }
}

/// λ = 1 − exp(−k·dt), in f64 so that small rates keep their digits.
fn damping(rate_per_s: f32, dt_secs: f32) -> f32 {
    (-f64::exp_m1(-f64::from(rate_per_s) * f64::from(dt_secs))) as f32
}
