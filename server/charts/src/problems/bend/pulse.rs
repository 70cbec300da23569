//! A round pulse of bent grass that spreads over an unbounded plain.

use std::collections::HashMap;
use std::f64::consts::PI;

use super::Oscillation;

/// `θ = A·exp(−r²/2σ²)` at rest at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pulse {
    /// A (rad).
    pub height_rad: f64,
    /// σ (m).
    pub width_m: f64,
    /// Speed of waves (m/s).
    pub speed_m_per_s: f64,
    /// Damping rate (1/s).
    pub damping_per_s: f64,
    /// Restoring rate κ (1/s²).
    pub stiffness_per_s2: f64,
}

/// Simpson's intervals over the wave numbers.
const INTERVALS: usize = 240;

impl Pulse {
    /// θ at a distance from the centre (m): the Hankel transform `∫ A·σ²·e^(−K²σ²/2)·a(K, t)·J₀(Kr)·K dK`, in which every wave number evolves
    /// independently. Simpson's rule, to seven digits.
    pub fn theta_rad(&self, distance_m: f64, secs: f64) -> f64 {
        // e^(−K²σ²/2) is 1e-11 there.
        let last = 7.2 / self.width_m;
        let step = last / INTERVALS as f64;
        let integrand = |n: usize| {
            let wave_number = n as f64 * step;
            let stiffness_per_s2 = (self.speed_m_per_s * wave_number).powi(2) + self.stiffness_per_s2;
            let amplitude = Oscillation { damping_per_s: self.damping_per_s, stiffness_per_s2 }.released(secs);
            (-0.5 * (wave_number * self.width_m).powi(2)).exp() * wave_number * amplitude * bessel_j0(wave_number * distance_m)
        };
        let weight = |n: usize| if n == 0 || n == INTERVALS { 1.0 } else { f64::from(2 + 2 * (n as u32 % 2)) };
        let sum: f64 = (0..=INTERVALS).map(|n| weight(n) * integrand(n)).sum();
        self.height_rad * self.width_m.powi(2) * sum * step / 3.0
    }

    /// θ at every cell of a square grid around the centre, row by row.
    pub fn on_grid(&self, cells: usize, cell_m: f64, secs: f64) -> Vec<f64> {
        // Cells at equal distance share a value.
        let mut known = HashMap::new();
        let odd = |n: usize| (2 * n as i64 + 1 - cells as i64).pow(2);
        let places = (0..cells * cells).map(|n| odd(n % cells) + odd(n / cells));
        places.map(|square| *known.entry(square).or_insert_with(|| self.theta_rad(0.5 * cell_m * (square as f64).sqrt(), secs))).collect()
    }
}

/// Bessel function of the first kind, `(1/π)·∫₀^π cos(x·sin τ) dτ`; the trapezoidal rule converges faster than any power of its step on a periodic integrand.
fn bessel_j0(x: f64) -> f64 {
    let points = 12 + (0.7 * x.abs()) as usize;
    (0..points).map(|n| (x * (PI * (n as f64 + 0.5) / points as f64).sin()).cos()).sum::<f64>() / points as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bessel_values_are_those_of_the_tables() {
        // Abramowitz & Stegun, table 9.1.
        for (x, value) in [(0.0, 1.0), (1.0, 0.7651976866), (5.0, -0.1775967713), (17.5, -0.1031103982), (40.0, 0.0073668906)] {
            assert!((bessel_j0(x) - value).abs() < 2e-10, "J0({x}) = {}", bessel_j0(x));
        }
    }

    #[test]
    fn a_pulse_starts_as_a_gaussian_and_obeys_the_wave_equation() {
        let pulse = Pulse { height_rad: 0.8, width_m: 0.7, speed_m_per_s: 2.0, damping_per_s: 0.6, stiffness_per_s2: 1.5 };
        for r in [0.0f64, 0.5, 2.0] {
            assert!((pulse.theta_rad(r, 0.0) - 0.8 * (-r * r / 0.98).exp()).abs() < 1e-7);
        }
        let (r, t, d) = (1.3, 0.9, 2e-3);
        let theta = |dr: f64, dt: f64| pulse.theta_rad(r + dr, t + dt);
        let [radial, in_time] = [[d, 0.0], [0.0, d]].map(|[x, y]| {
            let (above, below) = (theta(x, y), theta(-x, -y));
            [(above - below) / (2.0 * d), (above - 2.0 * theta(0.0, 0.0) + below) / (d * d)]
        });
        let left = in_time[1] + 0.6 * in_time[0] + 1.5 * theta(0.0, 0.0);
        let right = 4.0 * (radial[1] + radial[0] / r);
        assert!((left - right).abs() < 1e-4 * right.abs().max(1.0), "{left} for {right}");
    }
}
