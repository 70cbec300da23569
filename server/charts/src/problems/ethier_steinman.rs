//! An exact solution of the Navier–Stokes equations in three dimensions.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// The decaying Beltrami flow of Ethier & Steinman 1994, with their a = π/4 and d = π/2: its vorticity is along its
/// velocity, so that the pressure balances advection and viscosity alone makes it decay.
///
/// The paper's cube [−1, 1]³ becomes the box [0, side]³: positions are shifted by, and measured in, half the side, which keeps the solution exact at any
/// scale. The flow does not vanish on the faces: they need [`EthierSteinman::velocity`] prescribed.
#[derive(Clone, Copy, Debug)]
pub struct EthierSteinman {
    /// Side of the box (m). The paper's cube has 2.
    pub side_m: f64,
    /// Factor of the paper's velocities (m/s). The largest initial speed, on the surface of the box, is 3.5 times as much.
    pub speed_m_per_s: f64,
    /// Kinematic viscosity (m²/s). The paper has 1 for its dimensionless flow.
    pub viscosity_m2_per_s: f64,
}

const A: f64 = FRAC_PI_4;
const D: f64 = FRAC_PI_2;

impl EthierSteinman {
    /// Velocity (m/s) at a position (m) and time (s).
    pub fn velocity(&self, position_m: [f64; 3], time_secs: f64) -> [f64; 3] {
        let Phases { exp, sin, cos } = self.phases(position_m);
        let scale = -A * self.speed_m_per_s * self.decay(time_secs);
        std::array::from_fn(|i| {
            let [_, j, k] = cycle(i);
            scale * (exp[i] * sin[j] + exp[k] * cos[i])
        })
    }

    /// Pressure over density (m²/s²) at a position (m) and time (s), up to a constant.
    pub fn pressure(&self, position_m: [f64; 3], time_secs: f64) -> f64 {
        let Phases { exp, sin, cos } = self.phases(position_m);
        let sum: f64 = (0..3).map(cycle).map(|[i, j, k]| exp[i] * exp[i] + 2.0 * sin[i] * cos[k] * exp[j] * exp[k]).sum();
        let scale = A * self.speed_m_per_s * self.decay(time_secs);
        -0.5 * scale * scale * sum
    }

    fn decay(&self, time_secs: f64) -> f64 {
        let k = D / (0.5 * self.side_m);
        (-self.viscosity_m2_per_s * k * k * time_secs).exp()
    }

    fn phases(&self, position_m: [f64; 3]) -> Phases {
        let x = position_m.map(|x| 2.0 * x / self.side_m - 1.0);
        let phase = |i: usize| A * x[i] + D * x[cycle(i)[1]];
        Phases { exp: x.map(|x| (A * x).exp()), sin: std::array::from_fn(|i| phase(i).sin()), cos: std::array::from_fn(|i| phase(i).cos()) }
    }
}

/// An axis and the two after it, in the order x, y, z, x.
fn cycle(axis: usize) -> [usize; 3] {
    [axis, (axis + 1) % 3, (axis + 2) % 3]
}

/// `exp(a·xᵢ)`, and sine and cosine of `a·xᵢ + d·xᵢ₊₁`.
struct Phases {
    exp: [f64; 3],
    sin: [f64; 3],
    cos: [f64; 3],
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::differences::{gradient, navier_stokes};

    const POSITIONS_M: [[f64; 3]; 4] = [[0.3, 1.9, 0.8], [3.1, 0.2, 2.4], [1.6, 2.9, 0.1], [0.0, 0.0, 3.2]];

    #[test]
    fn it_solves_the_navier_stokes_equations() {
        let flow = EthierSteinman { side_m: 3.2, speed_m_per_s: 0.7, viscosity_m2_per_s: 0.4 };
        for position in POSITIONS_M {
            let (velocity, pressure) = (|x, t| flow.velocity(x, t), |x, t| flow.pressure(x, t));
            let left = navier_stokes(velocity, pressure, flow.viscosity_m2_per_s, (position, 0.3), (0.04, 0.02));
            assert!(left.divergence.abs() < 1e-10, "divergence {}", left.divergence);
            assert!(left.momentum.iter().all(|r| r.abs() < 1e-9), "momentum {:?}", left.momentum);
        }
    }

    #[test]
    fn its_vorticity_is_along_its_velocity() {
        let flow = EthierSteinman { side_m: 2.0, speed_m_per_s: 1.0, viscosity_m2_per_s: 1.0 };
        for position in POSITIONS_M.map(|x| x.map(|x| x / 1.6)) {
            let [du, dv, dw]: [[f64; 3]; 3] = std::array::from_fn(|c| gradient(|x| flow.velocity(x, 0.1)[c], position, 0.04));
            let vorticity = [dw[1] - dv[2], du[2] - dw[0], dv[0] - du[1]];
            let velocity = flow.velocity(position, 0.1);
            assert!(vorticity.iter().zip(velocity).all(|(rotation, u)| (rotation - D * u).abs() < 1e-9), "{vorticity:?} {velocity:?}");
        }
    }

    /// The paper's own formula for u, written out, at one corner of its cube.
    #[test]
    fn velocity_matches_the_published_formula() {
        let flow = EthierSteinman { side_m: 2.0, speed_m_per_s: 1.0, viscosity_m2_per_s: 1.0 };
        let ([x, y, z], t) = ([0.25, -0.5, 0.75], 0.2);
        let u = -A * ((A * x).exp() * (A * y + D * z).sin() + (A * z).exp() * (A * x + D * y).cos()) * (-D * D * t).exp();
        let found = flow.velocity([x + 1.0, y + 1.0, z + 1.0], t)[0];
        assert!((found - u).abs() < 1e-15, "{found} {u}");
    }
}
