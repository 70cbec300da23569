//! The explicit scheme on one grid, cell by cell, straight from its formula.

use std::ops::{Add, Div, Mul, Sub};

use prairie_core::bend::{Bend, CHANNELS, Coefficients, Damping, Edges, Field, GroundContact, WaveParams};

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
    ground_contact: GroundContact,
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
            ground_contact: GroundContact::None,
        }
    }

    /// Sets how grass that is bent to a right angle meets the ground.
    pub fn with_ground_contact(self, ground_contact: GroundContact) -> Self {
        Self { ground_contact, ..self }
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

    /// Sets all cells: θ, ωx and ωz now and `dt_secs` ago.
    pub fn start(&mut self, dt_secs: f32, state: impl Fn([usize; 2]) -> [[T; CHANNELS]; 2]) {
        for n in 0..self.kinds.len() {
            let [now, before] = state([n % self.size[0], n / self.size[0]]);
            for channel in 0..CHANNELS {
                (self.now[channel][n], self.before[channel][n]) = (now[channel], before[channel]);
            }
        }
        self.dt_secs = Some(dt_secs);
    }

    /// θ of all cells, row by row.
    pub fn thetas(&self) -> &[T] {
        &self.now[0]
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
        let [theta, x, z] = self.now.each_ref().map(|plane| [plane[n], laplacian(plane)]);
        let before = self.before.each_ref().map(|plane| plane[n]);
        let along = |[now, laplacian]: [T; 2], before: T| {
            (two - lambda_omega - restoring_omega) * now - (one - lambda_omega) * before + r2_omega * laplacian
        };
        let next = [along(x, before[1]), along(z, before[2])];
        let courant = |twice: T, [x, z]: [T; 2]| twice * r0 + r_mu * (x * x + z * z).root();
        let memory = one - lambda_theta;
        let next_theta = if k.keeps_motion || k.r_mu == 0.0 {
            let r = courant(one, [x[0], z[0]]);
            (one + memory - restoring_theta) * theta[0] - memory * before[0] + r * r * theta[1]
        } else {
            let ahead = courant(two, [x[0] + next[0], z[0] + next[1]]);
            let behind = courant(two, [x[0] + before[1], z[0] + before[2]]);
            let kept = memory * (ahead / behind) * (theta[0] - before[0]);
            theta[0] + kept + T::from(0.125) * ahead * (ahead + behind) * (theta[1] - T::from(k.stiffness) * theta[0])
        };
        let limit = self.ground_contact.limit_rad();
        let limits = [T::from(-limit), T::from(limit)];
        let held = if next_theta > limits[1] {
            limits[1]
        } else if next_theta < limits[0] {
            limits[0]
        } else {
            next_theta
        };
        [held, next[0], next[1]]
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
