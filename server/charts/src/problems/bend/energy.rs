//! Discrete energy of the undamped schemes.

use prairie_core::bend::{CHANNELS, Edges, Field, Scheme};

use super::{cells, channels, size};

/// Twice the discrete energy of each channel, per cell: `⟨v, M·v⟩ + ⟨a, K·a⁻⟩` with `v = a − a⁻`.
///
/// From `M·(a⁺ − 2a + a⁻) = −K·a` with symmetric M and K that do not change: its product with `a⁺ − a⁻` is the change of this sum. Explicit, M is 1;
/// by alternating directions `A·(1 − b·Lx)(1 − b·Lz)`; K is `−r²·L + κ·dt²` (Hairer et al. 2006, I.5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Energy {
    /// Courant number c·dt/h.
    pub courant: f64,
    /// κ·dt².
    pub restoring: f64,
    /// Edges of the world.
    pub edges: Edges,
}

impl Energy {
    /// Energies of θ, ωx and ωz under the explicit or the implicit scheme.
    ///
    /// # Panics
    /// When a patch sleeps.
    pub fn of(&self, field: &Field, scheme: Scheme) -> [f64; CHANNELS] {
        let size = size(field);
        let mut planes = [0; 2].map(|_| [0; CHANNELS].map(|_| vec![0.0; size[0] * size[1]]));
        let mut found = 0;
        for ([i, j], states) in cells(field) {
            for (planes, state) in planes.iter_mut().zip(states) {
                planes.iter_mut().zip(channels(state)).for_each(|(plane, value)| plane[j * size[0] + i] = f64::from(value));
            }
            found += 1;
        }
        assert_eq!(found, size[0] * size[1], "every patch is awake");
        std::array::from_fn(|channel| self.of_plane(size, &planes[0][channel], &planes[1][channel], scheme))
    }

    fn of_plane(&self, size: [usize; 2], now: &[f64], before: &[f64], scheme: Scheme) -> f64 {
        let r2 = self.courant * self.courant;
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let speed: Vec<f64> = now.iter().zip(before).map(|(now, before)| now - before).collect();
        let mut moved = speed.clone();
        if scheme == Scheme::Implicit {
            let inertia = 1.0 + 0.25 * self.restoring;
            for axis in [0, 1] {
                let differences = self.differences(size, &moved, axis);
                moved.iter_mut().zip(differences).for_each(|(value, second)| *value -= 0.25 * r2 / inertia * second);
            }
            moved.iter_mut().for_each(|value| *value *= inertia);
        }
        let [along, across] = [0, 1].map(|axis| self.differences(size, before, axis));
        let force: Vec<f64> = (0..before.len()).map(|n| self.restoring * before[n] - r2 * (along[n] + across[n])).collect();
        product(&speed, &moved) + product(now, &force)
    }

    /// Second differences along an axis.
    fn differences(&self, size: [usize; 2], plane: &[f64], axis: usize) -> Vec<f64> {
        let (count, stride) = (size[axis] as i64, if axis == 0 { 1 } else { size[0] });
        let value = |n: usize| {
            let at = (n / stride % size[axis]) as i64;
            let first = n - at as usize * stride;
            let beside = |to: i64| match (self.edges, (0..count).contains(&to)) {
                (_, true) => plane[first + to as usize * stride],
                (Edges::Rest, false) => 0.0,
                (Edges::Free, false) => plane[n],
                (Edges::Wrapped, false) => plane[first + to.rem_euclid(count) as usize * stride],
            };
            beside(at - 1) - 2.0 * plane[n] + beside(at + 1)
        };
        (0..plane.len()).map(value).collect()
    }
}
