//! The explicit scheme on one grid, cell by cell, straight from its formula.

use std::ops::{Add, Div, Mul, Sub};

use prairie_core::bend::{Bend, CHANNELS, Coefficients, Damping, Edges, Field, WaveParams};

use super::{channels, size};

/// Floating-point type of a grid.
pub trait Real: Copy + From<f32> + PartialOrd + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> {
    /// The positive root.
    fn root(self) -> Self;
    /// The nearest f32.
    fn rounded(self) -> f32;
}

impl Real for f32 {
    fn root(self) -> Self {
        self.sqrt()
    }

    fn rounded(self) -> f32 {
        self
    }
}

impl Real for f64 {
    fn root(self) -> Self {
        self.sqrt()
    }

    fn rounded(self) -> f32 {
        self as f32
    }
}

/// All cells of a world in one grid, without patches, halos or tiles: the arithmetic of the explicit schemes in [`prairie_core::bend`], in the same order. f32
/// gives identical bits; f64 shows the results without rounding errors, which dominate at steps shorter than a millisecond.
#[derive(Clone, Debug)]
pub struct OneGrid<T> {
    size: [usize; 2],
    cell_m: f32,
    edges: Edges,
    waves: Vec<WaveParams>,
    kinds: Vec<u8>,
    now: [Vec<T>; CHANNELS],
    before: [Vec<T>; CHANNELS],
    dt_secs: Option<f32>,
}

impl<T: Real> OneGrid<T> {
    /// A grid at rest with the cells and kinds of grass of a field.
    pub fn like(field: &Field, edges: Edges) -> Self {
        let size = size(field);
        let count = size[0] * size[1];
        let kind = |n: usize| field.kinds().kind(field.layout(), [n % size[0], n / size[0]].map(|n| n as i64));
        let zeros = || std::array::from_fn(|_| vec![T::from(0.0); count]);
        Self {
            size,
            cell_m: field.layout().cell_m,
            edges,
            waves: field.kinds().waves().to_vec(),
            kinds: (0..count).map(kind).collect(),
            now: zeros(),
            before: zeros(),
            dt_secs: None,
        }
    }

    /// Cells along X and Z.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Side of a cell (m).
    pub fn cell_m(&self) -> f32 {
        self.cell_m
    }

    /// Sets a cell as contact does.
    pub fn press(&mut self, cell: [usize; 2], bend: Bend) {
        let at = cell[1] * self.size[0] + cell[0];
        for (channel, value) in channels(bend).into_iter().enumerate() {
            (self.now[channel][at], self.before[channel][at]) = (value.into(), value.into());
        }
    }

    /// State of a cell.
    pub fn bend(&self, cell: [usize; 2]) -> Bend {
        let at = cell[1] * self.size[0] + cell[0];
        let [theta, x, z] = self.now.each_ref().map(|plane| plane[at].rounded());
        Bend { theta, omega: [x, z] }
    }

    /// Advances by `dt_secs` in `substeps` equal sub-steps.
    pub fn step(&mut self, damping: Damping, substeps: u32, dt_secs: f32) {
        let substep_secs = dt_secs / substeps as f32;
        let ratio = self.dt_secs.replace(substep_secs).map_or(1.0, |last| substep_secs / last);
        if ratio != 1.0 {
            let ratio = T::from(ratio);
            for (now, before) in self.now.iter().zip(&mut self.before) {
                now.iter().zip(before).for_each(|(now, before)| *before = *now - (*now - *before) * ratio);
            }
        }
        let kinds: Vec<_> = self.waves.iter().map(|waves| Coefficients::new(waves, self.cell_m, substep_secs, damping)).collect();
        for _ in 0..substeps {
            let next = |n: usize| self.next(n, &kinds[usize::from(self.kinds[n])]);
            let next: Vec<_> = (0..self.kinds.len()).map(next).collect();
            self.before = std::mem::replace(&mut self.now, std::array::from_fn(|channel| next.iter().map(|cell| cell[channel]).collect()));
        }
    }

    fn next(&self, n: usize, k: &Coefficients) -> [T; CHANNELS] {
        let [i, j] = [n % self.size[0], n / self.size[0]].map(|n| n as i64);
        let laplacian = |plane: &[T]| {
            let [east, south, west, north] =
                [[1, 0], [0, 1], [-1, 0], [0, -1]].map(|[x, z]| self.beside([i + x, j + z]).map_or(T::from(0.0), |at| plane[at]));
            (west + east) + (north + south) - T::from(4.0) * plane[n]
        };
        let [r0, r_mu, r2_omega, lambda_theta, lambda_omega] = [k.r0, k.r_mu, k.r2_omega, k.lambda_theta, k.lambda_omega].map(T::from);
        let [restoring_theta, restoring_omega] = k.restoring.map(T::from);
        let (one, two) = (T::from(1.0), T::from(2.0));
        let courant = |[_, x, z]: &[Vec<T>; CHANNELS]| r0 + r_mu * (x[n] * x[n] + z[n] * z[n]).root();
        let (r, r_before) = (courant(&self.now), courant(&self.before));
        let slowed = r / r_before;
        // A NaN quotient, where no wave runs, keeps the full motion.
        let kept = if !k.keeps_motion && slowed < one { slowed } else { one };
        let [theta, x, z] = self.now.each_ref().map(|plane| [plane[n], laplacian(plane)]);
        let before = self.before.each_ref().map(|plane| plane[n]);
        let memory = (one - lambda_theta) * kept;
        let along = |[now, laplacian]: [T; 2], before: T| {
            (two - lambda_omega - restoring_omega) * now - (one - lambda_omega) * before + r2_omega * laplacian
        };
        [(one + memory - restoring_theta) * theta[0] - memory * before[0] + r * r * theta[1], along(x, before[1]), along(z, before[2])]
    }

    fn beside(&self, cell: [i64; 2]) -> Option<usize> {
        let mut at = [0; 2];
        for axis in 0..2 {
            let count = self.size[axis] as i64;
            at[axis] = match self.edges {
                Edges::Rest if !(0..count).contains(&cell[axis]) => return None,
                Edges::Wrapped => cell[axis].rem_euclid(count),
                _ => cell[axis].clamp(0, count - 1),
            } as usize;
        }
        Some(at[1] * self.size[0] + at[0])
    }
}
