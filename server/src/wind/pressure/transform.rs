//! Direct solution of the Poisson equation by fast transforms along each axis.
//!
//! On a box with constant spacing the discrete Laplacian of each axis is diagonal in a basis of its own: the cosines of the DCT-II where the axis ends in
//! walls, the `cos + sin` of the discrete Hartley transform where it wraps. All are real, so a solve is: transform along z, y, x; divide each mode by the
//! sum of its three eigenvalues; transform back.
//!
//! A transform along an axis is also a rotation of the array that brings this axis to the front: lines are gathered from the slowest axis of the source
//! into contiguous ones, a block per task. Three such passes restore the order of axes. Plans are scalar on purpose: bits do not depend on the width of
//! the processor's vectors.

use std::sync::Arc;

use rustdct::algorithm::Type2And3ConvertToFft;
use rustdct::{DctPlanner, TransformType2And3};
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlannerScalar};

use crate::wind::parallel::for_each_chunk_pair;
use crate::wind::{Boundary, Grid, Real};

/// Solves `∇²p = f` on the cells of a grid, with periodic or zero-gradient ends.
pub struct Poisson {
    cells: [usize; 3],
    axes: [Axis; 3],
    eigenvalues: [Vec<f64>; 3],
    normalisation: f64,
    rotated: Vec<f64>,
}

#[derive(Clone, Copy)]
enum Way {
    Forward,
    Back,
}

impl Poisson {
    /// Plans the transforms of `grid` and allocates all that solving needs.
    pub fn new<R: Real>(grid: &Grid<R>) -> Self {
        let cells = grid.cells;
        // Transforming along an axis runs one task for each index of the next faster one.
        let axes: [Axis; 3] = std::array::from_fn(|axis| Axis::new(grid.boundary[axis], cells[axis], cells[(axis + 2) % 3]));
        let normalisation = axes.iter().fold(1.0, |product, axis| product / axis.gain());
        Self {
            cells,
            eigenvalues: std::array::from_fn(|axis| eigenvalues(grid, axis)),
            axes,
            normalisation,
            rotated: vec![0.0; grid.len()],
        }
    }

    /// Replaces the right-hand side `f` by the solution `p` of mean 0. The mean of `f`, which no solution can have, is dropped.
    ///
    /// Exact but for rounding: for a right-hand side as smooth as the box allows, the relative residual is about `(n/π)²·ε`. That is why it runs in
    /// double precision whatever the velocity does: in single precision it would be 1e-5 at 32 cells a side. Scalar transforms take the same time in both.
    pub fn solve(&mut self, field: &mut [f64]) {
        let [nx, ny, nz] = self.cells;
        let [x, y, z] = &mut self.axes;
        let rotated = &mut self.rotated[..];
        z.transform(Way::Forward, field, rotated, [nx, ny, nz]);
        y.transform(Way::Forward, rotated, field, [nz, nx, ny]);
        x.transform(Way::Forward, field, rotated, [ny, nz, nx]);
        divide_by_eigenvalues(&self.eigenvalues, self.normalisation, self.cells, rotated);
        z.transform(Way::Back, rotated, field, [nx, ny, nz]);
        y.transform(Way::Back, field, rotated, [nz, nx, ny]);
        x.transform(Way::Back, rotated, field, [ny, nz, nx]);
    }
}

/// Eigenvalues (1/m²) of the second difference along `axis`: `−(2/h)²·sin²(πk/n)` wrapped, `−(2/h)²·sin²(πk/2n)` between walls.
fn eigenvalues<R: Real>(grid: &Grid<R>, axis: usize) -> Vec<f64> {
    let n = grid.cells[axis];
    let half_turns = if grid.wraps(axis) { 1.0 } else { 0.5 };
    let h = grid.spacing_m[axis].wide();
    (0..n)
        .map(|k| {
            let wave = (std::f64::consts::PI * half_turns * k as f64 / n as f64).sin() * 2.0 / h;
            -wave * wave
        })
        .collect()
}

fn divide_by_eigenvalues(eigenvalues: &[Vec<f64>; 3], scale: f64, [nx, ny, _]: [usize; 3], modes: &mut [f64]) {
    let [along_x, along_y, along_z] = eigenvalues;
    crate::wind::parallel::for_each_chunk(modes, nx * ny, |k, plane| {
        for (row, &y) in plane.chunks_mut(nx).zip(along_y) {
            let yz = y + along_z[k];
            for (mode, &x) in row.iter_mut().zip(along_x) {
                *mode = *mode * scale / (x + yz);
            }
        }
    });
    modes[0] = 0.0;
}

/// The transform along one axis, with its plan and scratch.
struct Axis {
    len: usize,
    kind: Kind,
}

enum Kind {
    /// Discrete Hartley transform; its own inverse but for a factor n.
    Hartley { fft: Arc<dyn Fft<f64>>, scratch: Vec<Complex<f64>>, scratch_len: usize },
    /// DCT-II forward, DCT-III back; together they multiply by n/2.
    Cosine { dct: Arc<dyn TransformType2And3<f64>>, scratch: Vec<f64>, scratch_len: usize },
}

impl Axis {
    fn new(boundary: Boundary, len: usize, tasks: usize) -> Self {
        let mut planner = FftPlannerScalar::new();
        let kind = match boundary {
            Boundary::Wrap => {
                let fft = planner.plan_fft_forward(len);
                let scratch_len = len + fft.get_inplace_scratch_len();
                Kind::Hartley { fft, scratch: vec![Complex::default(); tasks * scratch_len], scratch_len }
            }
            Boundary::Wall => {
                // The cosine planner is scalar for powers of two only.
                let dct: Arc<dyn TransformType2And3<f64>> = if len > 1 && len.is_power_of_two() {
                    DctPlanner::new().plan_dct2(len)
                } else {
                    Arc::new(Type2And3ConvertToFft::new(planner.plan_fft_forward(len)))
                };
                let scratch_len = dct.get_scratch_len().max(1);
                Kind::Cosine { dct, scratch: vec![0.0; tasks * scratch_len], scratch_len }
            }
        };
        Self { len, kind }
    }

    /// What forward and back together multiply by.
    fn gain(&self) -> f64 {
        let n = self.len as f64;
        match self.kind {
            Kind::Hartley { .. } => n,
            Kind::Cosine { .. } => 0.5 * n,
        }
    }

    /// Transforms the lines along the slowest axis of `source`, of shape `[n0, n1, n2]`, into `target`, of shape `[n2, n0, n1]`.
    fn transform(&mut self, way: Way, source: &[f64], target: &mut [f64], [n0, n1, n2]: [usize; 3]) {
        match &mut self.kind {
            Kind::Hartley { fft, scratch, scratch_len } => {
                for_each_chunk_pair(target, n0 * n2, scratch, *scratch_len, |task, lines, scratch| {
                    gather(source, task, lines, [n0, n1, n2]);
                    lines.chunks_mut(2 * n2).for_each(|pair| hartley(&**fft, pair, n2, scratch));
                });
            }
            Kind::Cosine { dct, scratch, scratch_len } => {
                for_each_chunk_pair(target, n0 * n2, scratch, *scratch_len, |task, lines, scratch| {
                    gather(source, task, lines, [n0, n1, n2]);
                    for line in lines.chunks_mut(n2) {
                        match way {
                            Way::Forward => dct.process_dct2_with_scratch(line, scratch),
                            Way::Back => dct.process_dct3_with_scratch(line, scratch),
                        }
                    }
                });
            }
        }
    }
}

/// Copies the lines along the slowest axis of `source` whose middle index is `b` into `lines`, one after the other.
fn gather(source: &[f64], b: usize, lines: &mut [f64], [n0, n1, n2]: [usize; 3]) {
    for c in 0..n2 {
        let row = &source[n0 * (b + n1 * c)..][..n0];
        for (line, &value) in lines[c..].iter_mut().step_by(n2).zip(row) {
            *line = value;
        }
    }
}

/// Hartley transform `Σ x·(cos + sin)(2πkm/n)` of one or two lines of `n`, as the real and imaginary parts of one complex FFT.
fn hartley(fft: &dyn Fft<f64>, lines: &mut [f64], n: usize, scratch: &mut [Complex<f64>]) {
    let (buffer, scratch) = scratch.split_at_mut(n);
    let (first, second) = lines.split_at_mut(n);
    for (m, (z, &a)) in buffer.iter_mut().zip(&*first).enumerate() {
        *z = Complex::new(a, second.get(m).copied().unwrap_or(0.0));
    }
    fft.process_with_scratch(buffer, scratch);
    for (k, a) in first.iter_mut().enumerate() {
        let (z, mirrored) = (buffer[k], buffer[if k == 0 { 0 } else { n - k }]);
        *a = 0.5 * (z.re + mirrored.re - z.im + mirrored.im);
        if let Some(b) = second.get_mut(k) {
            *b = 0.5 * (z.im + mirrored.im + z.re - mirrored.re);
        }
    }
}
