//! Dynamic constraint: the force that a plant feels follows the force field with a delay (Endo et al. 2003, §4.3, after Barzel & Barr 1988).
//!
//! `F = −F_E − (2/τ)·m·v − (1/τ²)·m·(X − X₀)` together with the force F_E itself is a critically damped spring towards X₀: `X − X₀ = (A +
//! B·t)·e^(−t/τ)`. In this closed form a step of any length is exact, and two half steps equal a whole one.

/// A value that follows a target, and its rate of change.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Following {
    /// The value.
    pub value: [f32; 3],
    /// Its rate of change.
    pub rate_per_s: [f32; 3],
}

impl Following {
    /// The state after `dt_secs` ≥ 0 with a constant `target` and the time constant τ = `settle_secs` > 0; approaches it without overshoot.
    pub fn followed(&self, target: [f32; 3], settle_secs: f32, dt_secs: f32) -> Self {
        let taus = dt_secs / settle_secs;
        let decay = (-taus).exp();
        self.turned(target, [(1.0 + taus) * decay, dt_secs * decay], [-taus / settle_secs * decay, (1.0 - taus) * decay])
    }

    /// The state after `dt_secs` ≥ 0 by Endo et al. 2003, Eq. (5), without the velocity term: an undamped oscillation about the target, with
    /// period 2π·τ.
    pub fn swung(&self, target: [f32; 3], settle_secs: f32, dt_secs: f32) -> Self {
        let (sine, cosine) = (dt_secs / settle_secs).sin_cos();
        self.turned(target, [cosine, settle_secs * sine], [-sine / settle_secs, cosine])
    }

    /// A linear combination of deviation and rate.
    fn turned(&self, target: [f32; 3], value: [f32; 2], rate: [f32; 2]) -> Self {
        let mix = |i: usize, [of_deviation, of_rate]: [f32; 2]| of_deviation * (self.value[i] - target[i]) + of_rate * self.rate_per_s[i];
        Self { value: std::array::from_fn(|i| target[i] + mix(i, value)), rate_per_s: std::array::from_fn(|i| mix(i, rate)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The same motion by 4000 Runge–Kutta steps: `y'' = −2·damping/τ·y' − y/τ²`.
    fn integrated(start: [f64; 2], damping: f64, settle_secs: f64, secs: f64) -> [f64; 2] {
        let rate = |[y, v]: [f64; 2]| [v, -2.0 * damping / settle_secs * v - y / (settle_secs * settle_secs)];
        let steps = 4000;
        let h = secs / f64::from(steps);
        (0..steps).fold(start, |y, _| {
            let at = |k: [f64; 2], by: f64| [y[0] + by * k[0], y[1] + by * k[1]];
            let k1 = rate(y);
            let k2 = rate(at(k1, h / 2.0));
            let k3 = rate(at(k2, h / 2.0));
            let k4 = rate(at(k3, h));
            std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
        })
    }

    type Way = fn(&Following, [f32; 3], f32, f32) -> Following;
    const WAYS: [(Way, f64); 2] = [(Following::followed, 1.0), (Following::swung, 0.0)];

    proptest! {
        #[test]
        fn a_step_is_the_motion(value in -5.0f32..5.0, rate in -5.0f32..5.0, target in -5.0f32..5.0, settle in 0.05f32..2.0, taus in 0.0f32..6.0) {
            let start = Following { value: [value, 0.0, target], rate_per_s: [rate, 0.0, 0.0] };
            for (way, damping) in WAYS {
                let found = way(&start, [target, 0.0, target], settle, taus * settle);
                let [y, v] = integrated([f64::from(value - target), f64::from(rate)], damping, f64::from(settle), f64::from(taus * settle));
                prop_assert!((f64::from(found.value[0] - target) - y).abs() < 2e-5);
                prop_assert!((f64::from(found.rate_per_s[0]) - v).abs() * f64::from(settle) < 2e-5);
                prop_assert!(found.value[1..] == [0.0, target] && found.rate_per_s[1..] == [0.0, 0.0]);
            }
        }

        #[test]
        fn two_half_steps_are_one(value in -5.0f32..5.0, rate in -5.0f32..5.0, settle in 0.05f32..2.0, taus in 0.0f32..6.0) {
            let (start, target, dt) = (Following { value: [value; 3], rate_per_s: [rate; 3] }, [1.0; 3], taus * settle);
            for (way, _) in WAYS {
                let (one, two) = (way(&start, target, settle, dt), way(&way(&start, target, settle, 0.5 * dt), target, settle, 0.5 * dt));
                prop_assert!((one.value[0] - two.value[0]).abs() < 2e-5);
                prop_assert!((one.rate_per_s[0] - two.rate_per_s[0]).abs() * settle < 2e-5);
            }
        }
    }

    #[test]
    fn the_longest_step_rests_at_the_target_and_the_paper_s_never_does() {
        let start = Following { value: [3.0, -2.0, 0.0], rate_per_s: [40.0; 3] };
        assert_eq!(start.followed([1.0, 2.0, 3.0], 0.01, 1e9), Following { value: [1.0, 2.0, 3.0], rate_per_s: [0.0; 3] });
        let start = Following { value: [1.0, 0.0, 0.0], rate_per_s: [0.0; 3] };
        let after = start.swung([0.0; 3], 0.5, 100.0);
        let energy = after.value[0].powi(2) + (0.5 * after.rate_per_s[0]).powi(2);
        assert!((energy - 1.0).abs() < 1e-5, "{energy}");
    }
}
