//! Time integrators of one mode: `ẍ + 2γẋ + ω²x = 0`, x the distance from equilibrium.

use super::Blade;
use super::modes::{BRAKES, FREQUENCIES};

pub use crate::scene::BladeIntegrator as Integrator;

/// Squarings of the exponential of an eighth of a step.
const SQUARINGS: u32 = 3;

/// Linear map of a step on distance x and rate v: `x' = x + stay·x + glide·v`, `v' = v + pull·x + brake·v`. Increments are kept separate from x and v,
/// so that rounding is relative to the increments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Propagator {
    /// Increment of x per x.
    pub stay: f32,
    /// Increment of x per v (s).
    pub glide: f32,
    /// Increment of v per x (1/s).
    pub pull: f32,
    /// Increment of v per v.
    pub brake: f32,
}

impl Propagator {
    /// The map of a step of `dt_secs` for a mode with frequency ω (rad/s) and damping rate γ (1/s), both at least 0.
    #[inline(always)]
    pub fn new(integrator: Integrator, omega_rad_per_s: f32, gamma_per_s: f32, dt_secs: f32) -> Self {
        match integrator {
            Integrator::Euler => Self::euler(omega_rad_per_s, gamma_per_s, dt_secs),
            Integrator::Verlet => Self::verlet(omega_rad_per_s, gamma_per_s, dt_secs),
            Integrator::Exact => Self::exact(omega_rad_per_s, gamma_per_s, dt_secs),
        }
    }

    /// Explicit Euler, Zhang Eq. (6).
    #[inline(always)]
    fn euler(omega_rad_per_s: f32, gamma_per_s: f32, dt_secs: f32) -> Self {
        let pull = -(omega_rad_per_s * omega_rad_per_s * dt_secs);
        Self { stay: 0.0, glide: dt_secs, pull, brake: -2.0 * gamma_per_s * dt_secs }
    }

    /// Verlet, Zhang Eq. (7), `x' = 2x − x'' + a·dt²`, with v = (x − x'')/dt, which also gives the damping.
    #[inline(always)]
    fn verlet(omega_rad_per_s: f32, gamma_per_s: f32, dt_secs: f32) -> Self {
        let Self { pull, brake, .. } = Self::euler(omega_rad_per_s, gamma_per_s, dt_secs);
        Self { stay: pull * dt_secs, glide: dt_secs + brake * dt_secs, pull, brake }
    }

    /// The exponential of the matrix A of the mode, as `1 + e + p·A` (Cayley–Hamilton: A² = −ω² − 2γA): Padé's (2, 2) approximant of an eighth of the step, squared
    /// three times. Within 4e-6 of exact up to ω·dt = 1.5 and critical damping; bounded for every step and damping.
    #[inline(always)]
    fn exact(omega_rad_per_s: f32, gamma_per_s: f32, dt_secs: f32) -> Self {
        let h_secs = dt_secs / (1 << SQUARINGS) as f32;
        let twelfth = h_secs * h_secs / 12.0;
        let (omega2, gamma2) = (omega_rad_per_s * omega_rad_per_s, 2.0 * gamma_per_s);
        // Numerator and denominator 1 ± Ah/2 + (Ah)²/12 as a + up·A and a + down·A, with up = down + h.
        let a = 1.0 - omega2 * twelfth;
        let down = -(0.5 * h_secs + gamma2 * twelfth);
        let norm = a * a - gamma2 * a * down + omega2 * down * down;
        // (a + up·A)/(a + down·A) = 1 + e + p·A.
        let (mut e, mut p) = (omega2 * down * h_secs / norm, a * h_secs / norm);
        for _ in 0..SQUARINGS {
            (e, p) = (2.0 * e + e * e - omega2 * p * p, p * (2.0 + 2.0 * e - gamma2 * p));
        }
        Self { stay: e, glide: p, pull: -(omega2 * p), brake: e - gamma2 * p }
    }

    /// Increments of distance and rate in a step.
    #[inline(always)]
    pub fn change(&self, x: f32, v: f32) -> [f32; 2] {
        [self.stay * x + self.glide * v, self.pull * x + self.brake * v]
    }
}

/// Longest step (s) at which the highest mode of a blade stays bounded, from its lowest frequency ω₁ (rad/s) and the damping ratio of each mode.
///
/// Euler's amplification of a mode is |λ|² = 1 − 2γ·dt + ω²·dt², so `dt ≤ 2ζ/ω`; Verlet's with the damping of the old velocity has
/// `ω·dt ≤ 2·(√(1 + ζ²) − ζ)`; the exponential has no limit.
///
/// ```
/// use prairie_core::plant::blade::{Integrator, propagator::stable_dt_secs};
/// assert_eq!(stable_dt_secs(Integrator::Exact, 10.0, 0.1), f32::INFINITY);
/// assert_eq!(stable_dt_secs(Integrator::Euler, 10.0, 0.0), 0.0);
/// ```
pub fn stable_dt_secs(integrator: Integrator, frequency_rad_per_s: f32, damping_ratio: f32) -> f32 {
    mode_dt_secs(integrator, frequency_rad_per_s * FREQUENCIES[FREQUENCIES.len() - 1], damping_ratio)
}

/// Longest step (s) for which all modes of a blade stay bounded. Air passes its control points at up to `past_m_per_s`, and its drag damps the modes
/// as in [`advance`](super::advance).
///
/// ```
/// use prairie_core::plant::blade::{Blade, Integrator, propagator::{stable_dt_in_air_secs, stable_dt_secs}};
/// let blade = Blade { length_m: 0.8, frequency_rad_per_s: 10.0, damping_ratio: 0.1, lean_per_wind2: 0.005 };
/// let [calm, blown] = [0.0, 20.0].map(|past_m_per_s| stable_dt_in_air_secs(Integrator::Verlet, &blade, past_m_per_s));
/// assert_eq!(calm, stable_dt_secs(Integrator::Verlet, 10.0, 0.1));
/// assert!(blown < calm);
/// ```
pub fn stable_dt_in_air_secs(integrator: Integrator, blade: &Blade, past_m_per_s: f32) -> f32 {
    let omega = blade.frequency_rad_per_s;
    let braked = 0.5 * blade.length_m * omega * omega * blade.lean_per_wind2 * past_m_per_s;
    let modes = FREQUENCIES.iter().zip(BRAKES).flat_map(|(&times, brakes)| {
        let drag_fraction = braked * brakes.iter().sum::<f32>() / (omega * times);
        // Limits rise up to critical damping and fall beyond it, so the smallest is at an end.
        [0.0, drag_fraction].map(|drag_fraction| mode_dt_secs(integrator, omega * times, blade.damping_ratio + drag_fraction))
    });
    modes.fold(f32::INFINITY, f32::min)
}

/// Longest step (s) at which one mode stays bounded.
fn mode_dt_secs(integrator: Integrator, omega_rad_per_s: f32, damping_ratio: f32) -> f32 {
    match integrator {
        Integrator::Euler if damping_ratio < 1.0 => 2.0 * damping_ratio / omega_rad_per_s,
        Integrator::Euler => 2.0 * (damping_ratio - (damping_ratio * damping_ratio - 1.0).sqrt()) / omega_rad_per_s,
        Integrator::Verlet => 2.0 * ((1.0 + damping_ratio * damping_ratio).sqrt() - damping_ratio) / omega_rad_per_s,
        Integrator::Exact => f32::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn after(step: &Propagator, [x, v]: [f32; 2]) -> [f32; 2] {
        let [dx, dv] = step.change(x, v);
        [x + dx, v + dv]
    }

    /// The exponential in f64 by its closed form.
    fn closed(omega: f64, gamma: f64, t: f64, [x, v]: [f64; 2]) -> [f64; 2] {
        let spread = omega * omega - gamma * gamma;
        let root = spread.abs().sqrt();
        let (c, s) = match spread {
            s if s > 0.0 => ((root * t).cos(), (root * t).sin() / root),
            s if s < 0.0 => ((root * t).cosh(), (root * t).sinh() / root),
            _ => (1.0, t),
        };
        let decay = (-gamma * t).exp();
        [decay * (x * c + (v + gamma * x) * s), decay * (v * c - (omega * omega * x + gamma * v) * s)]
    }

    proptest! {
        #[test]
        fn the_exponential_is_exact(omega in 0.0_f32..200.0, fraction in 0.0_f32..1.0, step in 0.0_f32..1.5, x in -1.0_f32..1.0, v in -1.0_f32..1.0) {
            let dt = step / omega.max(1.0);
            let v = v * omega.max(1.0);
            let found = after(&Propagator::exact(omega, fraction * omega, dt), [x, v]);
            let wanted = closed(f64::from(omega), f64::from(fraction * omega), f64::from(dt), [f64::from(x), f64::from(v)]);
            let scale = [1.0, f64::from(omega.max(1.0))];
            prop_assert!((0..2).all(|i| (f64::from(found[i]) - wanted[i]).abs() < 4e-6 * scale[i]), "{found:?} instead of {wanted:?}");
        }

        #[test]
        fn no_step_is_too_long_for_the_exponential(omega in 0.1_f32..1e4, fraction in 0.0_f32..10.0, dt in 1e-4_f32..10.0) {
            let step = Propagator::exact(omega, fraction * omega, dt);
            let [mut x, mut v] = [1.0_f32, 0.0];
            for _ in 0..200 {
                [x, v] = after(&step, [x, v]);
                prop_assert!(x.abs() <= 1.001 && v.abs() <= 1.001 * omega, "{x}, {v}");
            }
        }

        #[test]
        fn limits_are_where_amplitudes_start_to_grow(verlet in any::<bool>(), omega in 1.0_f32..50.0, fraction in 0.02_f32..0.9) {
            let integrator = if verlet { Integrator::Verlet } else { Integrator::Euler };
            let highest = omega * FREQUENCIES[2];
            let grows = |dt: f32| {
                let step = Propagator::new(integrator, highest, fraction * highest, dt);
                let scale = f64::from(highest);
                let mut many = [
                    [1.0 + f64::from(step.stay), scale * f64::from(step.glide)],
                    [f64::from(step.pull) / scale, 1.0 + f64::from(step.brake)],
                ];
                // 2²⁶ steps.
                for _ in 0..26 {
                    let [[a, b], [c, d]] = many;
                    many = [[a * a + b * c, b * (a + d)], [c * (a + d), b * c + d * d]];
                    if many.as_flattened().iter().any(|v| v.abs() > 1e9) {
                        return true;
                    }
                }
                false
            };
            let (mut low, mut high) = (0.0, 4.0 / highest);
            for _ in 0..30 {
                let middle = 0.5 * (low + high);
                if grows(middle) { high = middle } else { low = middle }
            }
            let limit = stable_dt_secs(integrator, omega, fraction);
            prop_assert!((low / limit - 1.0).abs() < 0.01, "{low} for {limit}");
        }
    }

    #[test]
    fn two_half_steps_are_a_whole_one() {
        let (half, whole) = (Propagator::exact(12.0, 1.5, 0.02), Propagator::exact(12.0, 1.5, 0.04));
        let (twice, once) = (after(&half, after(&half, [0.3, -2.0])), after(&whole, [0.3, -2.0]));
        assert!((twice[0] - once[0]).abs() < 1e-6 && (twice[1] - once[1]).abs() < 1e-5);
    }
}
