//! Problems with exact solutions.

use std::f64::consts::TAU;

/// The decaying Taylor–Green vortex (Taylor & Green, Proc. R. Soc. A 158, 1937) in the x–z plane of a box that wraps, over a uniform mean wind:
/// an exact solution of the Navier–Stokes equations at any viscosity.
#[derive(Clone, Copy, Debug)]
pub struct TaylorGreen {
    /// Side of the square that holds one period (m).
    pub side_m: f64,
    /// Speed of the vortices at the start (m/s).
    pub speed_m_per_s: f64,
    /// Velocity (m/s) along x and z the vortices drift with.
    pub drift_m_per_s: [f64; 2],
    /// Kinematic viscosity (m²/s).
    pub viscosity_m2_per_s: f64,
}

impl TaylorGreen {
    /// Velocity (m/s) at a position (m) and time (s).
    pub fn velocity(&self, [x, _, z]: [f64; 3], time_secs: f64) -> [f64; 3] {
        let k = TAU / self.side_m;
        let speed = self.speed_m_per_s * (-2.0 * self.viscosity_m2_per_s * k * k * time_secs).exp();
        let [drift_x, drift_z] = self.drift_m_per_s;
        let (x, z) = (k * (x - drift_x * time_secs), k * (z - drift_z * time_secs));
        [drift_x + speed * x.sin() * z.cos(), 0.0, drift_z - speed * x.cos() * z.sin()]
    }
}

/// A smooth periodic hill of concentration carried along by a uniform wind.
pub fn drifting_hill(side_m: f64, [x, _, z]: [f64; 3], wind_m_per_s: [f64; 2], time_secs: f64) -> f64 {
    let k = TAU / side_m;
    let (x, z) = (x - wind_m_per_s[0] * time_secs, z - wind_m_per_s[1] * time_secs);
    1.0 + 0.5 * (k * x).sin() * (k * z).cos()
}
