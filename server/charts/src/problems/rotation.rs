//! Solid-body rotation of a scalar: Zalesak's disc and a Gaussian hill.

use std::f64::consts::TAU;

/// Solid-body rotation about the middle of a square in the x–z plane: after each period, a carried scalar is back at its start.
///
/// Air flows through the faces of the box. Either [`Rotation::velocity`] is prescribed there, or the scalar stays within the inscribed circle.
#[derive(Clone, Copy, Debug)]
pub struct Rotation {
    /// Side of the square (m).
    pub side_m: f64,
    /// Time of one turn (s).
    pub period_secs: f64,
}

impl Rotation {
    /// Velocity (m/s) at a position (m): `u = ω·(c − z)`, `w = ω·(x − c)`.
    pub fn velocity(&self, [x, _, z]: [f64; 3]) -> [f64; 3] {
        let (omega, centre) = (TAU / self.period_secs, 0.5 * self.side_m);
        [omega * (centre - z), 0.0, omega * (x - centre)]
    }

    /// Position at time 0 of the air now at a position (m), in units of the side along x and z.
    fn origin(&self, [x, _, z]: [f64; 3], time_secs: f64) -> [f64; 2] {
        let (x, z) = (x / self.side_m - 0.5, z / self.side_m - 0.5);
        let (sin, cos) = (TAU * time_secs / self.period_secs).sin_cos();
        [0.5 + cos * x + sin * z, 0.5 - sin * x + cos * z]
    }
}

/// The slotted disc of Zalesak 1979: on a square of 100, a disc of radius 15 about (50, 75) with a slot 5 wide and 25 long from its
/// lower rim; density 1 inside, 0 outside. It is turned once, in 628 steps at unit spacing.
#[derive(Clone, Copy, Debug)]
pub struct SlottedDisc(pub Rotation);

impl SlottedDisc {
    /// Density at a position (m) and time (s).
    pub fn density(&self, position_m: [f64; 3], time_secs: f64) -> f64 {
        let [x, z] = self.0.origin(position_m, time_secs);
        let in_disc = (x - 0.5).hypot(z - 0.75) <= 0.15;
        let in_slot = (x - 0.5).abs() < 0.025 && z < 0.85;
        if in_disc && !in_slot { 1.0 } else { 0.0 }
    }

    /// Mean density of the cell of `cell_m` (m) along x and z around a position (m), from `samples` × `samples` points: the initial and final value of a
    /// conservative scheme.
    pub fn mean_density(&self, [x, y, z]: [f64; 3], cell_m: [f64; 2], samples: usize, time_secs: f64) -> f64 {
        let offset = |n: usize, size: f64| ((n as f64 + 0.5) / samples as f64 - 0.5) * size;
        let points = (0..samples * samples).map(|n| [x + offset(n % samples, cell_m[0]), y, z + offset(n / samples, cell_m[1])]);
        points.map(|point| self.density(point, time_secs)).sum::<f64>() / (samples * samples) as f64
    }
}

/// A Gaussian hill of height 1 a quarter of the side from the centre of a turning square. Nothing diffuses: it keeps its shape, and its error is that of
/// advection alone.
#[derive(Clone, Copy, Debug)]
pub struct RotatingGaussian {
    /// Its rotation.
    pub rotation: Rotation,
    /// Standard deviation as a fraction of the side. Up to 0.04, the density outside the inscribed circle is below 1e-8.
    pub width: f64,
}

impl RotatingGaussian {
    /// Density at a position (m) and time (s).
    pub fn density(&self, position_m: [f64; 3], time_secs: f64) -> f64 {
        let [x, z] = self.rotation.origin(position_m, time_secs);
        let (x, z) = ((x - 0.5) / self.width, (z - 0.75) / self.width);
        (-0.5 * (x * x + z * z)).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::differences::{gradient, rate};

    const ROTATION: Rotation = Rotation { side_m: 100.0, period_secs: 628.0 };

    #[test]
    fn the_hill_solves_the_advection_equation() {
        let hill = RotatingGaussian { rotation: ROTATION, width: 0.05 };
        for position in [[50.0, 0.0, 70.0], [47.0, 0.0, 78.0], [30.0, 0.0, 60.0]] {
            for time in [0.0, 37.0] {
                let slope = gradient(|x| hill.density(x, time), position, 0.5);
                let [u, _, w] = ROTATION.velocity(position);
                let changed = rate(|t| hill.density(position, t), time, 1.0);
                assert!((changed + u * slope[0] + w * slope[2]).abs() < 1e-8, "{changed}");
            }
        }
    }

    #[test]
    fn the_hill_is_where_it_should_be_after_a_quarter_and_a_whole_turn() {
        let hill = RotatingGaussian { rotation: ROTATION, width: 0.05 };
        for (position, time) in
            [([50.0, 0.0, 75.0], 0.0), ([25.0, 0.0, 50.0], 157.0), ([50.0, 0.0, 25.0], 314.0), ([50.0, 0.0, 75.0], 628.0)]
        {
            assert!((hill.density(position, time) - 1.0).abs() < 1e-12, "{time}");
        }
    }

    #[test]
    fn the_slot_has_zalesaks_position_and_size() {
        let disc = SlottedDisc(ROTATION);
        let inside = [[36.0, 0.0, 75.0], [50.0, 0.0, 85.1], [52.6, 0.0, 70.0], [47.4, 0.0, 61.0], [50.0, 0.0, 89.9]];
        let outside = [[34.9, 0.0, 75.0], [50.0, 0.0, 84.9], [52.4, 0.0, 70.0], [47.6, 0.0, 61.0], [50.0, 0.0, 90.1]];
        assert!(inside.iter().all(|&x| disc.density(x, 0.0) == 1.0));
        assert!(outside.iter().all(|&x| disc.density(x, 0.0) == 0.0));
    }

    /// Disc without slot: π·15². The slot removes a rectangle 5 by 25 from 60 to 85, except for the two slivers outside the disc at the rim.
    #[test]
    fn the_area_of_the_disc_is_conserved() {
        let disc = SlottedDisc(ROTATION);
        let chord = 15.0 * 15.0 * (2.5f64 / 15.0).asin() + 2.5 * (15.0f64 * 15.0 - 2.5 * 2.5).sqrt();
        let exact = std::f64::consts::PI * 15.0 * 15.0 - (5.0 * 10.0 + chord);
        for time in [0.0, 100.0, 628.0] {
            let cells = (0..100 * 100).map(|n| [(n % 100) as f64 + 0.5, 0.0, (n / 100) as f64 + 0.5]);
            let area: f64 = cells.map(|position| disc.mean_density(position, [1.0; 2], 8, time)).sum();
            assert!((area - exact).abs() < 0.5, "{time} s: {area} {exact}");
        }
    }
}
