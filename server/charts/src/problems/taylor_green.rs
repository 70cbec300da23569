//! The Taylor–Green vortex.

use std::f64::consts::TAU;

/// The decaying Taylor–Green vortex (Taylor & Green 1937) in the x–z plane of a periodic box, with a uniform mean wind:
/// an exact solution of the Navier–Stokes equations at any viscosity.
#[derive(Clone, Copy, Debug)]
pub struct TaylorGreen {
    /// Side of the square that holds one period (m).
    pub side_m: f64,
    /// Speed of the vortices at the start (m/s).
    pub speed_m_per_s: f64,
    /// Drift velocity of the vortices along x and z (m/s).
    pub drift_m_per_s: [f64; 2],
    /// Kinematic viscosity (m²/s).
    pub viscosity_m2_per_s: f64,
}

impl TaylorGreen {
    /// Velocity (m/s) at a position (m) and time (s).
    pub fn velocity(&self, position_m: [f64; 3], time_secs: f64) -> [f64; 3] {
        let (speed, [x, z]) = self.at(position_m, time_secs);
        let [drift_x, drift_z] = self.drift_m_per_s;
        [drift_x + speed * x.sin() * z.cos(), 0.0, drift_z - speed * x.cos() * z.sin()]
    }

    /// Pressure over density (m²/s²), of mean 0, at a position (m) and time (s).
    pub fn pressure(&self, position_m: [f64; 3], time_secs: f64) -> f64 {
        let (speed, [x, z]) = self.at(position_m, time_secs);
        0.25 * speed * speed * ((2.0 * x).cos() + (2.0 * z).cos())
    }

    /// Remaining speed, and the phase at a position.
    fn at(&self, [x, _, z]: [f64; 3], time_secs: f64) -> (f64, [f64; 2]) {
        let k = TAU / self.side_m;
        let [drift_x, drift_z] = self.drift_m_per_s;
        let speed = self.speed_m_per_s * (-2.0 * self.viscosity_m2_per_s * k * k * time_secs).exp();
        (speed, [k * (x - drift_x * time_secs), k * (z - drift_z * time_secs)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::differences::navier_stokes;

    #[test]
    fn it_solves_the_navier_stokes_equations() {
        let flow = TaylorGreen { side_m: 10.0, speed_m_per_s: 1.5, drift_m_per_s: [0.5, -0.25], viscosity_m2_per_s: 0.3 };
        for position in [[1.0, 0.0, 2.0], [4.4, 1.0, 9.0], [8.1, 2.0, 3.3]] {
            let (velocity, pressure) = (|x, t| flow.velocity(x, t), |x, t| flow.pressure(x, t));
            let left = navier_stokes(velocity, pressure, flow.viscosity_m2_per_s, (position, 0.8), (0.1, 0.05));
            assert!(left.divergence.abs() < 1e-10, "divergence {}", left.divergence);
            assert!(left.momentum.iter().all(|r| r.abs() < 1e-9), "momentum {:?}", left.momentum);
        }
    }
}
