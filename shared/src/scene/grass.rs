//! How the grass bends: the constants of the bend field.

use serde::{Deserialize, Serialize};

/// Constants of the bend field (001 §4.4), in units: speeds in m/s, damping as a rate in 1/s, so that results do not
/// depend on the time step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Grass {
    /// Base speed c₀ at which θ spreads (m/s), 001 Eq. (4). Default 1, allowed 0..=50; 001 uses 1..=10.
    pub c0_m_per_s: f32,
    /// How the bending speed adds to the speed of θ, μ (m/rad), 001 Eq. (4). Default 0.05, allowed 0..=10; 001 uses 0..=1.5.
    pub mu_m_per_rad: f32,
    /// Speed c_ω at which the bending velocity spreads (m/s), 001 Eq. (3). Default 1, allowed 0..=50.
    pub c_omega_m_per_s: f32,
    /// Damping rate k_θ (1/s): 001's λ_θ = 1 − exp(−k_θ·dt). Default 6, allowed 0..=200.
    pub theta_damping_per_s: f32,
    /// Damping rate k_ω (1/s) of the bending velocity. Default 6, allowed 0..=200.
    pub omega_damping_per_s: f32,
    /// Restoring rate κ (1/s²): adds −κ·θ to Eq. (2) and −κ·ω to Eq. (3), so that bent grass rises even where nothing
    /// carries the bend away; the slow time constant is k/κ. Default 1.2 (tracks rise in about 5 s), allowed 0..=10000; 001 has 0.
    pub stiffness_per_s2: f32,
    /// Largest bend on flat land (rad). Default 1.45, allowed 0.1..=1.57.
    pub theta_max_rad: f32,
    /// Bend that a wind of 10 m/s sustains (rad); grows with the square of the speed below it. Default 0.5, allowed 0..=1.5.
    pub wind_bend_rad: f32,
    /// How long the tip's bend comes after the root's (s): γ of the topmost segment, 001 Eq. (7); those between share it evenly. Default 0.12, allowed
    /// 0..=1.
    pub lag_secs: f32,
    /// Share of that lag while the grass rises again, when its upper parts trail less (001 §4.5). Default 0.4, allowed 0..=1.
    pub recovery_lag_share: f32,
    /// Segments that bend one after the other, from the root up; 1 is stiff, short grass, which bends as a whole. Default 3, allowed 1..=6.
    pub segments: u32,
    /// Time in which grass that an object's weight has laid rises to 1/e of its lean (s). Default 60, allowed 0.5..=86400.
    pub laid_recovery_secs: f32,
}

impl Default for Grass {
    fn default() -> Self {
        Self {
            c0_m_per_s: 1.0,
            mu_m_per_rad: 0.05,
            c_omega_m_per_s: 1.0,
            theta_damping_per_s: 6.0,
            omega_damping_per_s: 6.0,
            stiffness_per_s2: 1.2,
            theta_max_rad: 1.45,
            wind_bend_rad: 0.5,
            lag_secs: 0.12,
            recovery_lag_share: 0.4,
            segments: 3,
            laid_recovery_secs: 60.0,
        }
    }
}
