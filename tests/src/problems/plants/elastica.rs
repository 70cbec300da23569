//! A component under its own weight as a continuous beam.

use std::f64::consts::PI;

/// Steps of the integration along the beam.
const STEPS: u32 = 4000;

/// Tip of a beam of length 1, from its foot: how far aside, and how high against the load. It stands `unbent_rad`, above 0, off upright; its weight is
/// `weight` times EI/L², its rigidity falls linearly to `tip_share` of EI at the tip.
///
/// The elastica `(EI·θ')' = −Λ·(1 − s)·sin θ` by Runge–Kutta steps from the tip down to the clamp, and the tip's angle by bisection.
pub fn heavy_elastica(tip_share: f64, weight: f64, unbent_rad: f64) -> [f64; 2] {
    // Angle, moment, place; along t from the tip.
    let rate = |t: f64, [angle, moment, _, _]: [f64; 4]| {
        let rigidity = tip_share + (1.0 - tip_share) * t;
        [-moment / rigidity, weight * t * angle.sin(), angle.sin(), angle.cos()]
    };
    // Where the foot is; none once the beam is bent back beyond its clamp.
    let shot = |tip_rad: f64| {
        let h = 1.0 / f64::from(STEPS);
        (0..STEPS).try_fold([tip_rad, 0.0, 0.0, 0.0], |y, step| {
            let t = f64::from(step) * h;
            let at = |k: [f64; 4], by: f64| std::array::from_fn(|n| y[n] + by * k[n]);
            let first = rate(t, y);
            let second = rate(t + h / 2.0, at(first, h / 2.0));
            let third = rate(t + h / 2.0, at(second, h / 2.0));
            let fourth = rate(t + h, at(third, h));
            let next: [f64; 4] = std::array::from_fn(|n| y[n] + h / 6.0 * (first[n] + 2.0 * second[n] + 2.0 * third[n] + fourth[n]));
            (next[0] >= unbent_rad).then_some(next)
        })
    };
    let (mut low, mut high, mut tip) = (unbent_rad, PI, [0.0; 2]);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if let Some([_, _, aside, up]) = shot(middle) {
            (high, tip) = (middle, [aside, up]);
        } else {
            low = middle;
        }
    }
    tip
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_light_beam_droops_by_an_eighth_of_its_weight() {
        // A cantilever that lies level: w·L⁴/(8·EI).
        let [aside, up] = heavy_elastica(1.0, 0.01, 0.5 * PI);
        assert!((up + 0.01 / 8.0).abs() < 1e-6 && (aside - 1.0).abs() < 1e-5, "{aside}, {up}");
    }

    #[test]
    fn a_heavy_beam_hangs() {
        let [aside, up] = heavy_elastica(0.5, 1000.0, 1.0);
        assert!(up < -0.7 && aside < 0.2, "{aside}, {up}");
    }
}
