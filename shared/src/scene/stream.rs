//! Largest errors of the streamed fields.

use serde::{Deserialize, Serialize};

/// Largest errors of the fields where they are sent as [codes](crate::wire::quantise). Half the error costs about one more bit for each cell that moves. The
/// world itself reads the wind from its codes. Grass that lies flattened may be off by another `theta_error_deg` while it recovers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Stream {
    /// Bending angle (degrees). Default 0.5, allowed 0.05..=5.
    pub theta_error_deg: f32,
    /// Component of the bending velocity, where it is 1 rad/s (rad/s); elsewhere the error is in proportion to the root of the velocity. Default 0.07, allowed
    /// 0.01..=1.
    pub omega_error_rad_per_s: f32,
    /// Component of the wind (m/s). Default 0.125, allowed 0.01..=1.
    pub wind_error_m_per_s: f32,
    /// Concentration of dust, where it is 1; elsewhere the error is in proportion to the root of the concentration. Default 0.03, allowed 0.005..=0.5.
    pub dust_error: f32,
}

impl Default for Stream {
    fn default() -> Self {
        Self { theta_error_deg: 0.5, omega_error_rad_per_s: 0.07, wind_error_m_per_s: 0.125, dust_error: 0.03 }
    }
}
