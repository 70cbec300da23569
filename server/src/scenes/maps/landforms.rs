//! Building blocks of terrain: noise, hills, curves, and points scattered with a minimum distance.

use noise::{NoiseFn, OpenSimplex, Perlin};
use prairie_core::random::SplitMix64;

/// A point in plan view (m): X, Z.
pub(super) type Point = [f64; 2];

/// Fractal lattice noise: each octave has half the wavelength and `gain` times the amplitude of the previous one.
pub(super) struct Noise {
    lattice: Box<dyn NoiseFn<f64, 2>>,
    wavelength_m: f64,
    octaves: u32,
    gain: f64,
}

impl Noise {
    /// OpenSimplex noise.
    pub(super) fn new(seed: u32, wavelength_m: f64, octaves: u32, gain: f64) -> Self {
        Self { lattice: Box::new(OpenSimplex::new(seed)), wavelength_m, octaves, gain }
    }

    /// Perlin noise, without the faint artefacts of [`new`](Self::new) that show on long gentle slopes.
    pub(super) fn smooth(seed: u32, wavelength_m: f64, octaves: u32, gain: f64) -> Self {
        Self { lattice: Box::new(Perlin::new(seed)), wavelength_m, octaves, gain }
    }

    /// Value at a point, approximately −1..1.
    pub(super) fn at(&self, [x, z]: Point) -> f64 {
        let (mut sum, mut weight, mut scale, mut total) = (0.0, 1.0, 1.0 / self.wavelength_m, 0.0);
        for octave in 0..self.octaves {
            let shift = f64::from(octave) * 17.31;
            sum += weight * self.lattice.get([x * scale + shift, z * scale - shift]);
            total += weight;
            weight *= self.gain;
            scale *= 2.0;
        }
        sum / total
    }
}

/// 0 below `low`, 1 above `high`, and a cubic (Hermite) step between.
pub(super) fn smooth_step(low: f64, high: f64, value: f64) -> f64 {
    let t = ((value - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

pub(super) fn distance(a: Point, b: Point) -> f64 {
    let [x, z] = [a[0] - b[0], a[1] - b[1]];
    (x * x + z * z).sqrt()
}

/// A round hill: 1 at the centre, ½ at `radius_m`, decaying with the fourth power of the distance.
pub(super) fn bump(at: Point, centre: Point, radius_m: f64) -> f64 {
    let r = distance(at, centre) / radius_m;
    1.0 / (1.0 + r * r * r * r)
}

/// A Catmull-Rom spline through points, as a polyline.
pub(super) struct Spline {
    points: Vec<Point>,
}

impl Spline {
    pub(super) fn through(knots: &[Point]) -> Self {
        const PIECES: usize = 16;
        let knot = |i: usize| knots[i.clamp(1, knots.len()) - 1];
        let mut points = vec![knots[0]];
        for i in 1..knots.len() {
            for piece in 1..=PIECES {
                let t = piece as f64 / PIECES as f64;
                points.push(std::array::from_fn(|axis| {
                    let [a, b, c, d] = [knot(i - 1), knot(i), knot(i + 1), knot(i + 2)].map(|p| p[axis]);
                    b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)))
                }));
            }
        }
        Self { points }
    }

    /// Distance of a point from the curve (m).
    pub(super) fn distance(&self, at: Point) -> f64 {
        let to_line = |line: &[Point]| {
            let [from, to] = [line[0], line[1]];
            let along = [to[0] - from[0], to[1] - from[1]];
            let length2 = along[0] * along[0] + along[1] * along[1];
            let t = ((at[0] - from[0]) * along[0] + (at[1] - from[1]) * along[1]) / length2;
            let t = t.clamp(0.0, 1.0);
            distance(at, [from[0] + t * along[0], from[1] + t * along[1]])
        };
        self.points.windows(2).map(to_line).fold(f64::INFINITY, f64::min)
    }
}

/// Scatters at most `count` points over `extent_m`: uniformly distributed, each kept with the probability `chance`, and at least
/// `apart_m` from each other.
pub(super) fn scatter(random: &mut SplitMix64, extent_m: Point, count: usize, apart_m: f64, chance: impl Fn(Point) -> f64) -> Vec<Point> {
    let columns = (extent_m[0] / apart_m) as usize + 1;
    let rows = (extent_m[1] / apart_m) as usize + 1;
    let mut bins: Vec<Vec<Point>> = vec![Vec::new(); columns * rows];
    let mut kept = Vec::with_capacity(count);
    for _ in 0..count * 400 {
        if kept.len() == count {
            break;
        }
        let at = [random.unit() * extent_m[0], random.unit() * extent_m[1]];
        let keep = random.unit() < chance(at);
        let (column, row) = ((at[0] / apart_m) as usize, (at[1] / apart_m) as usize);
        let near = || {
            (row.saturating_sub(1)..(row + 2).min(rows))
                .flat_map(|row| (column.saturating_sub(1)..(column + 2).min(columns)).map(move |column| row * columns + column))
                .flat_map(|bin| &bins[bin])
        };
        if keep && near().all(|&other| distance(at, other) >= apart_m) {
            bins[row * columns + column].push(at);
            kept.push(at);
        }
    }
    kept
}
