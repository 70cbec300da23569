//! Exact solutions between moving walls: the air moves along x, its speed depends on the height alone, and nothing but friction acts.

use std::f64::consts::PI;

/// Couette flow that starts from rest (Schlichting & Gersten, Boundary-Layer Theory, 9th ed., ch. 5.3.4): the lower wall is at rest, the upper one moves from time 0 on.
#[derive(Clone, Copy, Debug)]
pub struct CouetteStart {
    /// Distance of the walls (m).
    pub height_m: f64,
    /// Speed of the upper wall (m/s).
    pub speed_m_per_s: f64,
    /// Kinematic viscosity (m²/s).
    pub viscosity_m2_per_s: f64,
}

impl CouetteStart {
    /// Speed (m/s) at a height (m) and a time (s) above 0.
    pub fn speed(&self, height_m: f64, time_secs: f64) -> f64 {
        let y = height_m / self.height_m;
        let decay = PI * PI * self.viscosity_m2_per_s * time_secs / (self.height_m * self.height_m);
        // exp(−40) is below the rounding of a sum of order 1.
        let terms = (40.0 / decay).sqrt().ceil() as u32;
        let term = |n: f64| (1.0 - 2.0 * (n % 2.0)) * 2.0 / (n * PI) * (-n * n * decay).exp() * (n * PI * y).sin();
        self.speed_m_per_s * (y + (1..=terms).map(|n| term(f64::from(n))).sum::<f64>())
    }
}

/// Stokes' second problem (Stokes, Trans. Camb. Phil. Soc. 9 (1851)): air above a wall that oscillates in its plane.
#[derive(Clone, Copy, Debug)]
pub struct OscillatingWall {
    /// Largest speed of the wall (m/s).
    pub speed_m_per_s: f64,
    /// Height (m) at which the air lags by one radian and its amplitude is 1/e of the wall's.
    pub depth_m: f64,
    /// Kinematic viscosity (m²/s).
    pub viscosity_m2_per_s: f64,
}

impl OscillatingWall {
    /// Speed (m/s) at a height (m) and time (s).
    pub fn speed(&self, height_m: f64, time_secs: f64) -> f64 {
        let y = height_m / self.depth_m;
        let phase = 2.0 * self.viscosity_m2_per_s * time_secs / (self.depth_m * self.depth_m) - y;
        self.speed_m_per_s * (-y).exp() * phase.cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::differences::{laplacian, rate};

    const COUETTE: CouetteStart = CouetteStart { height_m: 3.0, speed_m_per_s: 0.8, viscosity_m2_per_s: 0.5 };
    const STOKES: OscillatingWall = OscillatingWall { speed_m_per_s: 0.8, depth_m: 1.3, viscosity_m2_per_s: 0.5 };

    fn assert_diffuses(speed: impl Fn(f64, f64) -> f64, viscosity_m2_per_s: f64) {
        for (height, time) in [(0.4, 1.0), (1.5, 0.6), (2.6, 2.0)] {
            let change = rate(|t| speed(height, t), time, 0.01);
            let friction = viscosity_m2_per_s * laplacian(|[_, y, _]| speed(y, time), [0.0, height, 0.0], 0.04);
            assert!((change - friction).abs() < 1e-9, "at {height} m, {time} s: {change} {friction}");
        }
    }

    #[test]
    fn both_solve_the_diffusion_equation() {
        assert_diffuses(|y, t| COUETTE.speed(y, t), COUETTE.viscosity_m2_per_s);
        assert_diffuses(|y, t| STOKES.speed(y, t), STOKES.viscosity_m2_per_s);
    }

    #[test]
    fn the_air_sticks_to_the_walls_and_starts_from_rest() {
        for time in [0.01, 0.5, 9.0] {
            assert!(COUETTE.speed(0.0, time).abs() < 1e-14 && (COUETTE.speed(3.0, time) - 0.8).abs() < 1e-13);
        }
        assert!([0.3, 1.5, 2.4].iter().all(|&height| COUETTE.speed(height, 0.005).abs() < 1e-12));
        assert!((COUETTE.speed(1.5, 100.0) - 0.4).abs() < 1e-14);
        let quarter_secs = 0.5 * PI * STOKES.depth_m * STOKES.depth_m / (2.0 * STOKES.viscosity_m2_per_s);
        assert!((STOKES.speed(0.0, 0.0) - 0.8).abs() < 1e-15 && STOKES.speed(0.0, quarter_secs).abs() < 1e-15);
    }
}
