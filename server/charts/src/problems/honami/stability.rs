//! Linear stability of wind over and in a canopy of oscillators.
//!
//! The mean wind U(y) is the steady solution of `0 = R·(U_∞ − U) + ν·U″ − C_d·a·U²`. Waves `(φ, q)·exp(ikx + σt)` of the stream function (u = φ′, v = −ikφ) and of the
//! tops of the stems, p = σq, obey
//!
//! ```text
//! (σ + ikU)·(φ″ − k²φ) − ikU″φ = ν·(d²/dy² − k²)²φ − (2r·(φ′ − χp))′ + k²rφ,    r = C_d·a·U
//! σp = −ω₀²q − 2ζω₀p + (ρ/M)·∫ 2r·χ·(φ′ − χp) dy
//! ```
//!
//! This is the mechanism of Py, de Langre & Moulia (2006), linear waves of a shear layer and of stems that its drag couples, with a smooth profile and eddy viscosity. They are solved here by finite differences for
//! the stream function, on another grid and in other variables than those of the wind solver.

use super::{AIR_KG_PER_M3, Meadow, Wave};
use nalgebra::{Complex, DMatrix, DVector};

type Matrix = DMatrix<Complex<f64>>;
type Vector = DVector<Complex<f64>>;

const I: Complex<f64> = Complex::new(0.0, 1.0);

/// The dominant mode is separated from others by 2 to this power of steps of the propagator.
const SQUARINGS: usize = 12;
/// Number of wave lengths compared, less one.
const LENGTHS: u32 = 24;

/// The mean wind and its second derivative at equally spaced heights, from the ground to the top of the box.
#[derive(Clone, Debug)]
pub struct MeanFlow {
    /// Nodes per height of the canopy.
    nodes: usize,
    /// Distance between nodes (m).
    pub spacing_m: f64,
    /// Wind (m/s).
    pub wind_m_per_s: Vec<f64>,
    /// U″ (1/(m·s)).
    curvature: Vec<f64>,
    /// Fraction of canopy around each node.
    canopy: Vec<f64>,
}

impl MeanFlow {
    /// The steady wind over `meadow`, by Newton's method, at this number of nodes per height of the canopy.
    pub fn new(meadow: &Meadow, nodes: usize) -> Self {
        let top = nodes * Meadow::BOX_HEIGHTS;
        let spacing_m = meadow.height_m / nodes as f64;
        let canopy: Vec<f64> = (0..=top).map(|n| [1.0, 0.5, 0.0][usize::from(n >= nodes) + usize::from(n > nodes)]).collect();
        let mut wind: Vec<f64> = canopy.iter().map(|part| meadow.wind_m_per_s * (1.0 - 0.7 * part)).collect();
        let (friction, rate) = (meadow.viscosity_m2_per_s() / spacing_m.powi(2), meadow.relaxation_per_s());
        let curved = |wind: &[f64], n: usize| wind[n.abs_diff(1)] - 2.0 * wind[n] + wind[if n == top { top - 1 } else { n + 1 }];
        for _ in 0..60 {
            let force = |n: usize| {
                let drag = meadow.drag_per_m * canopy[n] * wind[n] * wind[n].abs();
                rate * (meadow.wind_m_per_s - wind[n]) - drag + friction * curved(&wind, n)
            };
            let slope = |n: usize| rate + 2.0 * meadow.drag_per_m * canopy[n] * wind[n].abs() + 2.0 * friction;
            let change = line_solve(friction, (0..=top).map(slope).collect(), (0..=top).map(force).collect());
            wind.iter_mut().zip(change).for_each(|(wind, change)| *wind += change);
        }
        let curvature = (0..=top).map(|n| curved(&wind, n) / spacing_m.powi(2)).collect();
        Self { nodes, spacing_m, wind_m_per_s: wind, curvature, canopy }
    }

    /// Wind (m/s) at a height (m), linear between nodes.
    pub fn at(&self, height_m: f64) -> f64 {
        let place = (height_m / self.spacing_m).clamp(0.0, (self.wind_m_per_s.len() - 2) as f64);
        let below = place.floor();
        let [low, high] = [0, 1].map(|n| self.wind_m_per_s[below as usize + n]);
        low + (high - low) * (place - below)
    }

    /// Thickness (m) of the shear layer: difference of the wind above and below over the largest gradient.
    pub fn vorticity_thickness_m(&self) -> f64 {
        let gradient = self.wind_m_per_s.windows(2).map(|pair| (pair[1] - pair[0]) / self.spacing_m).fold(0.0, f64::max);
        (self.wind_m_per_s[self.wind_m_per_s.len() - 1] - self.wind_m_per_s[0]) / gradient
    }
}

/// Solution of a tridiagonal system with `−side` beside the diagonal, doubled in the first and last row.
fn line_solve(side: f64, mut diagonal: Vec<f64>, mut right: Vec<f64>) -> Vec<f64> {
    let last = right.len() - 1;
    for n in 1..=last {
        let above = if n == 1 { 2.0 * side } else { side };
        let own = if n == last { 2.0 * side } else { side };
        let factor = own / diagonal[n - 1];
        diagonal[n] -= factor * above;
        right[n] += factor * right[n - 1];
    }
    right[last] /= diagonal[last];
    for n in (0..last).rev() {
        let above = if n == 0 { 2.0 * side } else { side };
        right[n] = (right[n] + above * right[n + 1]) / diagonal[n];
    }
    right
}

/// The most amplified wave at wave number `k_per_m`: the mode that is left by repeated squaring of a Crank–Nicolson step, sharpened by inverse iteration.
///
/// # Panics
/// If a matrix is singular.
pub fn wave(meadow: &Meadow, flow: &MeanFlow, k_per_m: f64) -> Wave {
    let matrix = evolution(meadow, flow, k_per_m);
    let n = matrix.nrows();
    let half_secs = Complex::from(0.05 * meadow.height_m / meadow.wind_m_per_s);
    let identity = Matrix::identity(n, n);
    let ahead = &identity + &matrix * half_secs;
    let mut propagator = (&identity - &matrix * half_secs).lu().solve(&ahead).expect("regular");
    for _ in 0..SQUARINGS {
        let squared = &propagator * &propagator;
        let largest = squared.iter().map(|value| value.norm()).fold(0.0, f64::max);
        propagator = squared.unscale(largest);
    }
    let mode = propagator * Vector::from_fn(n, |row, _| Complex::from_polar(1.0, row as f64));
    sharpened(&matrix, k_per_m, mode)
}

/// The wave of a mode that is nearly an eigenvector.
fn sharpened(matrix: &Matrix, k_per_m: f64, mut mode: Vector) -> Wave {
    let mut growth = rayleigh(matrix, &mode);
    for _ in 0..3 {
        // A shift a little beside the estimate keeps the system regular.
        let shift = growth * (1.0 + 1e-7);
        let shifted = matrix - Matrix::identity(matrix.nrows(), matrix.nrows()) * shift;
        mode = shifted.lu().solve(&mode).expect("regular").normalize();
        growth = rayleigh(matrix, &mode);
    }
    Wave { k_per_m, growth_per_s: growth.re, frequency_rad_per_s: -growth.im }
}

fn rayleigh(matrix: &Matrix, mode: &Vector) -> Complex<f64> {
    mode.dotc(&(matrix * mode)) / mode.dotc(mode)
}

/// Matrix A of `dz/dt = A·z`, z the stream function at the inner nodes and, if the stems move, q and p.
fn evolution(meadow: &Meadow, flow: &MeanFlow, k_per_m: f64) -> Matrix {
    let (step, inner, k) = (flow.spacing_m, flow.wind_m_per_s.len() - 2, k_per_m);
    let n = inner + if meadow.motion.is_some() { 2 } else { 0 };
    // Laplacian of waves, on the inner nodes; the stream function and the vorticity vanish at both ends.
    let laplacian = Matrix::from_fn(inner, inner, |row, column| match row.abs_diff(column) {
        0 => (-2.0 / step.powi(2) - k * k).into(),
        1 => step.powi(-2).into(),
        _ => Complex::default(),
    });
    let mut right = Matrix::zeros(inner, n);
    let friction = &laplacian * &laplacian * Complex::from(meadow.viscosity_m2_per_s());
    for row in 0..inner {
        let wind = I * (k * flow.wind_m_per_s[row + 1]);
        (0..inner).for_each(|column| right[(row, column)] = friction[(row, column)] - wind * laplacian[(row, column)]);
        let drag = meadow.drag_per_m * flow.canopy[row + 1] * flow.wind_m_per_s[row + 1];
        right[(row, row)] += I * (k * flow.curvature[row + 1]) + k * k * drag;
    }
    let mut last = Matrix::zeros(2, n);
    for middle in 0..flow.nodes {
        // The drag on u halfway between two nodes, `2r·(φ′ − χp)`, as a row.
        let rate = meadow.drag_per_m * (flow.wind_m_per_s[middle] + flow.wind_m_per_s[middle + 1]);
        let shape = (middle as f64 + 0.5) / flow.nodes as f64;
        let mut drag = vec![(middle, rate / step)];
        drag.extend(middle.checked_sub(1).map(|below| (below, -rate / step)));
        drag.extend(meadow.motion.map(|_| (n - 1, -rate * shape)));
        for (column, value) in drag {
            right[(middle, column)] += Complex::from(value / step);
            if middle > 0 {
                right[(middle - 1, column)] -= Complex::from(value / step);
            }
            if let Some(motion) = &meadow.motion {
                last[(1, column)] += Complex::from(value * AIR_KG_PER_M3 * shape * step / modal_mass_kg_per_m2(motion));
            }
        }
    }
    let rows = laplacian.lu().solve(&right).expect("regular");
    let Some(motion) = &meadow.motion else { return rows };
    let rad_per_s = std::f64::consts::TAU * f64::from(motion.frequency_hz);
    last[(0, n - 1)] = Complex::from(1.0);
    last[(1, n - 2)] -= Complex::from(rad_per_s.powi(2));
    last[(1, n - 1)] -= Complex::from(2.0 * f64::from(motion.damping_ratio) * rad_per_s);
    Matrix::from_fn(n, n, |row, column| if row < inner { rows[(row, column)] } else { last[(row - inner, column)] })
}

/// The most amplified of all waves whose length is 1.5 to 10 heights of the canopy, at this number of nodes per height.
///
/// # Panics
/// As [`wave`].
pub fn most_amplified(meadow: &Meadow, nodes: usize) -> Wave {
    let flow = MeanFlow::new(meadow, nodes);
    let ratio = (10.0f64 / 1.5).powf(1.0 / f64::from(LENGTHS));
    let number = |n: f64| std::f64::consts::TAU / (10.0 * meadow.height_m) * ratio.powf(n);
    let waves: Vec<Wave> = (0..=LENGTHS).map(|n| wave(meadow, &flow, number(n.into()))).collect();
    let inner = 1..LENGTHS as usize;
    let best = inner.max_by(|&a, &b| waves[a].growth_per_s.total_cmp(&waves[b].growth_per_s)).expect("waves");
    // The vertex of the parabola through the best and its neighbours.
    let [a, b, c] = [best - 1, best, best + 1].map(|n| waves[n].growth_per_s);
    let bend = a - 2.0 * b + c;
    let offset = if bend < 0.0 { (0.5 * (a - c) / bend).clamp(-1.0, 1.0) } else { 0.0 };
    wave(meadow, &flow, number(best as f64 + offset))
}

/// Modal mass (kg/m²) of straight stems that turn about their feet: a third of the mass.
fn modal_mass_kg_per_m2(motion: &prairie_wind::CanopyMotion) -> f64 {
    f64::from(motion.mass_kg_per_m2) / 3.0
}
