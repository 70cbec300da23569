//! The elastica: exact shape of an elastic beam at any bend (Bisshopp & Drucker 1945), as a reference.

use super::rest::Load;
use std::f64::consts::PI;

/// Number of steps of the integration along the beam.
const STEPS: u32 = 1000;

/// Tip of a clamped beam of length 1, relative to its foot: distance aside, and height against the load's direction. The unbent beam is `unbent_rad` off
/// upright; its rigidity falls linearly from EI at the foot to `tip_fraction`·EI at the tip.
///
/// Integrates `(EI·ψ')' = (P + Λ·t)·sin ψ` from the tip, ψ the angle from the load's direction, by Runge–Kutta steps; finds the tip's angle by bisection of
/// its logarithm. Slow; a reference for [`balanced`](super::rest::balanced).
pub fn tip(tip_fraction: f64, load: Load, unbent_rad: f64) -> [f64; 2] {
    let h = 1.0 / f64::from(STEPS);
    // Angle, moment, position.
    let rate = |t: f64, [angle, moment, ..]: [f64; 4]| {
        let rigidity = tip_fraction + (1.0 - tip_fraction) * t;
        [moment / rigidity, (load.tip + load.spread * t) * angle.sin(), angle.sin(), -angle.cos()]
    };
    // `None` once the beam is bent back beyond its clamp.
    let shot = |tip_rad: f64| {
        (0..STEPS).try_fold([tip_rad, 0.0, 0.0, 0.0], |y, step| {
            let t = f64::from(step) * h;
            let at = |k: [f64; 4], by: f64| std::array::from_fn(|n| y[n] + by * k[n]);
            let first = rate(t, y);
            let second = rate(t + h / 2.0, at(first, h / 2.0));
            let third = rate(t + h / 2.0, at(second, h / 2.0));
            let fourth = rate(t + h, at(third, h));
            let next: [f64; 4] = std::array::from_fn(|n| y[n] + h / 6.0 * (first[n] + 2.0 * second[n] + 2.0 * third[n] + fourth[n]));
            (next[0] <= PI - unbent_rad).then_some(next)
        })
    };
    let (mut low, mut high, mut tip) = (1e-30_f64, PI - unbent_rad, [0.0; 2]);
    for _ in 0..56 {
        let middle = (low * high).sqrt();
        if let Some([_, _, aside, up]) = shot(middle) {
            (low, tip) = (middle, [aside, up]);
        } else {
            high = middle;
        }
    }
    tip
}

/// Tip of a beam under its own weight alone, as [`tip`] gives it: `weight` is in units of EI/L².
pub fn heavy_tip(tip_fraction: f64, weight: f64, unbent_rad: f64) -> [f64; 2] {
    tip(tip_fraction, Load { spread: weight, tip: 0.0 }, unbent_rad)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_light_beam_droops_by_an_eighth_of_its_weight() {
        // A horizontal cantilever: w·L⁴/(8·EI).
        let [aside, up] = heavy_tip(1.0, 0.01, 0.5 * PI);
        assert!((up + 0.01 / 8.0).abs() < 1e-6 && (aside - 1.0).abs() < 1e-5, "{aside}, {up}");
    }

    #[test]
    fn a_heavy_beam_hangs() {
        let [aside, up] = heavy_tip(0.5, 1000.0, 1.0);
        assert!(up < -0.7 && aside < 0.2, "{aside}, {up}");
    }
}
