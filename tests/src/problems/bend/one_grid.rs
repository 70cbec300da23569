//! The explicit scheme on one grid, cell by cell as its formula stands.

use shared::bend::{Bend, CHANNELS, Coefficients, Damping, Edges, Field, WaveParams};

use super::{channels, size};

/// All cells of a world in one grid, without patches, halos or tiles; the arithmetic of [`shared::bend`]'s explicit schemes, in the same order.
#[derive(Clone, Debug)]
pub struct OneGrid {
    size: [usize; 2],
    cell_m: f32,
    edges: Edges,
    waves: Vec<WaveParams>,
    kinds: Vec<u8>,
    now: [Vec<f32>; CHANNELS],
    before: [Vec<f32>; CHANNELS],
    dt_secs: Option<f32>,
}

impl OneGrid {
    /// A grid at rest with the cells and kinds of grass of a field.
    pub fn like(field: &Field, edges: Edges) -> Self {
        let size = size(field);
        let count = size[0] * size[1];
        let kind = |n: usize| field.kinds().kind(field.layout(), [n % size[0], n / size[0]].map(|n| n as i64));
        let zeros = || std::array::from_fn(|_| vec![0.0; count]);
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

    /// Sets a cell as contact does.
    pub fn press(&mut self, cell: [usize; 2], bend: Bend) {
        let at = cell[1] * self.size[0] + cell[0];
        for (channel, value) in channels(bend).into_iter().enumerate() {
            (self.now[channel][at], self.before[channel][at]) = (value, value);
        }
    }

    /// State of a cell.
    pub fn bend(&self, cell: [usize; 2]) -> Bend {
        let at = cell[1] * self.size[0] + cell[0];
        let [theta, x, z] = self.now.each_ref().map(|plane| plane[at]);
        Bend { theta, omega: [x, z] }
    }

    /// Advances by `dt_secs` in so many equal sub-steps.
    pub fn step(&mut self, damping: Damping, substeps: u32, dt_secs: f32) {
        let substep_secs = dt_secs / substeps as f32;
        let ratio = self.dt_secs.replace(substep_secs).map_or(1.0, |last| substep_secs / last);
        if ratio != 1.0 {
            for (now, before) in self.now.iter().zip(&mut self.before) {
                now.iter().zip(before).for_each(|(now, before)| *before = now - (now - *before) * ratio);
            }
        }
        let kinds: Vec<_> = self.waves.iter().map(|waves| Coefficients::new(waves, self.cell_m, substep_secs, damping)).collect();
        for _ in 0..substeps {
            let next = |n: usize| self.next(n, &kinds[usize::from(self.kinds[n])]);
            let next: Vec<_> = (0..self.kinds.len()).map(next).collect();
            self.before = std::mem::replace(&mut self.now, std::array::from_fn(|channel| next.iter().map(|cell| cell[channel]).collect()));
        }
    }

    fn next(&self, n: usize, k: &Coefficients) -> [f32; CHANNELS] {
        let [i, j] = [n % self.size[0], n / self.size[0]].map(|n| n as i64);
        let laplacian = |plane: &[f32]| {
            let [east, south, west, north] =
                [[1, 0], [0, 1], [-1, 0], [0, -1]].map(|[x, z]| self.beside([i + x, j + z]).map_or(0.0, |at| plane[at]));
            (west + east) + (north + south) - 4.0 * plane[n]
        };
        let courant = |[_, x, z]: &[Vec<f32>; CHANNELS]| k.r0 + k.r_mu * (x[n] * x[n] + z[n] * z[n]).sqrt();
        let (r, r_before) = (courant(&self.now), courant(&self.before));
        let slowed = if r < r_before { (r / r_before).max(k.kept_at_least) } else { 1.0 };
        let [theta, x, z] = self.now.each_ref().map(|plane| [plane[n], laplacian(plane)]);
        let before = self.before.each_ref().map(|plane| plane[n]);
        let memory = (1.0 - k.lambda_theta) * slowed;
        let along = |[now, laplacian]: [f32; 2], before: f32| {
            (2.0 - k.lambda_omega - k.restoring[1]) * now - (1.0 - k.lambda_omega) * before + k.r2_omega * laplacian
        };
        [(1.0 + memory - k.restoring[0]) * theta[0] - memory * before[0] + r * r * theta[1], along(x, before[1]), along(z, before[2])]
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
