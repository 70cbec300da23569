//! Direct solution of `(shift − ∇²)·φ = f` on a box with constant spacing along each axis.
//!
//! There the seven-point Laplacian is a sum of one second difference per axis, each diagonal in its own basis of waves. A solve transforms every
//! plane along x and y, solves a tridiagonal system along z for each pair of waves, and transforms back (Swarztrauber, "The methods of cyclic
//! reduction, Fourier analysis and the FACR algorithm", SIAM Review 19 (1977)). The field passes through memory three times; all other work is done
//! in cache, eight lines at a time.
//!
//! Fused multiply-add is never used and tasks are independent: results are bit-identical for any vector width of the processor and any number of
//! threads.

mod basis;
mod columns;
mod fft;
mod lanes;
mod line;
mod plane;
#[cfg(test)]
mod tests;
mod walls;

pub use self::basis::{Basis, Edge};

use std::array::from_fn;

use self::columns::{Row, WIDTH};
use self::lanes::LINES;
use self::line::Line;
use self::plane::Lines;
use super::parallel::for_each_chunk_pair;

/// Maximum number of tasks in a pass over the field, whatever the number of threads.
const TASKS: usize = 32;

/// A planned solver of `(shift − ∇²)·φ = f` with the seven-point Laplacian.
///
/// Takes time proportional to the number of unknowns and to the sum of the prime factors of the transform lengths along x and y: products of 2, 3 and 5
/// are best (for nodes between two Dirichlet edges, one less than these); nodes on a Neumann edge and centres next to walls take time proportional to the square of their number. All lengths along z are equally efficient.
///
/// ```
/// use prairie_wind::separable::{Basis, Edge, Separable};
///
/// // Implicit diffusion of a spike between walls that keep it in: ν·dt = 0.5 m².
/// let walls = Basis::Centres([Edge::Neumann; 2]);
/// let mut solver = Separable::new([8, 8, 8], [0.5; 3], [walls; 3]);
/// let mut field = vec![0.0; 512];
/// field[0] = 1.0;
/// let shift = 1.0 / 0.5;
/// field.iter_mut().for_each(|value| *value *= shift);
/// solver.solve(shift, &mut field);
/// assert!((field.iter().sum::<f64>() - 1.0).abs() < 1e-14);
/// ```
pub struct Separable {
    cells: [usize; 3],
    x: Line,
    y: Line,
    along_z: Basis,
    /// Sum of the eigenvalues (1/m²) along x and y of each mode of a plane, one row per block of columns.
    eigenvalues: Vec<Row>,
    /// Square of the spacing along z (m²).
    spacing_squared: f64,
    /// True if a constant solves the homogeneous equation without shift.
    has_constant: bool,
    /// The modes, one block of columns after the other.
    blocks: Vec<f64>,
    scratch: Vec<Scratch>,
}

/// Work arrays of one task.
#[derive(Clone)]
struct Scratch {
    lines: Lines,
    columns: Vec<Row>,
}

impl Separable {
    /// Plans solves on `cells` unknowns (each ≥ 1) `spacing_m` (m, > 0) apart, and allocates the memory they need: a little more than 8 bytes per
    /// unknown.
    ///
    /// # Panics
    /// If an axis has no unknowns.
    pub fn new(cells: [usize; 3], spacing_m: [f64; 3], axes: [Basis; 3]) -> Self {
        assert!(cells.iter().all(|&n| n > 0), "an axis without unknowns");
        // An axis of one unknown may be in any position; putting it last leaves two longer ones for the plane.
        let mut order = [0, 1, 2];
        order.sort_by_key(|&axis| cells[axis] == 1);
        let (cells, spacing_m, axes) =
            (order.map(|axis| cells[axis]), order.map(|axis| spacing_m[axis]), order.map(|axis| axes[axis].reduced(cells[axis])));
        let [nx, ny, nz] = cells;
        let [x, y] = from_fn(|axis| Line::new(axes[axis], cells[axis], spacing_m[axis]));

        let bands = y.eigenvalues.chunks(LINES);
        let of_plane =
            bands.flat_map(|band| x.eigenvalues.iter().flat_map(move |along_x| band.iter().map(move |along_y| along_x + along_y)));
        let mut eigenvalues = vec![[0.0; WIDTH]; (nx * ny).div_ceil(WIDTH)];
        eigenvalues.as_flattened_mut().iter_mut().zip(of_plane).for_each(|(slot, eigenvalue)| *slot = eigenvalue);

        let scratch = Scratch { lines: Lines::new(&x, &y), columns: vec![[0.0; WIDTH]; 2 * nz] };
        Self {
            cells,
            blocks: vec![0.0; eigenvalues.len() * nz * WIDTH],
            scratch: vec![scratch; TASKS],
            spacing_squared: spacing_m[2] * spacing_m[2],
            has_constant: axes.iter().all(|axis| matches!(axis, Basis::Wrap | Basis::Centres([Edge::Neumann, Edge::Neumann]))),
            along_z: axes[2],
            eigenvalues,
            x,
            y,
        }
    }

    /// Replaces the right-hand side `f` by the solution φ; x varies fastest. `shift` (1/m², ≥ 0) may differ between calls: 0 for a pressure,
    /// `1/(ν·dt)` for implicit diffusion.
    ///
    /// Without shift and without a Dirichlet end or nodes on any axis, the constant is in the null space: the mean of `f` is dropped and φ has mean 0.
    /// Nodes between two Neumann edges need a shift, or a Dirichlet end on another axis. Exact except for rounding, which the Laplacian of φ amplifies by up to `(n/π)²`.
    ///
    /// # Panics
    /// If the length of `field` is not the number of unknowns.
    pub fn solve(&mut self, shift: f64, field: &mut [f64]) {
        let Self { cells: [nx, ny, nz], x, y, blocks, scratch, .. } = self;
        let (nz, plane_len) = (*nz, *nx * *ny);
        assert_eq!(field.len(), nz * plane_len, "the field does not fit the solver");
        let is_singular = self.has_constant && shift == 0.0;
        let planes_per_task = nz.div_ceil(TASKS);
        let blocks_per_task = self.eigenvalues.len().div_ceil(TASKS);
        let block_len = nz * WIDTH;

        for_each_chunk_pair(field, planes_per_task * plane_len, scratch, 1, |_, planes, scratch| {
            planes.chunks_exact_mut(plane_len).for_each(|plane| plane::to_modes(x, y, plane, &mut scratch[0].lines));
        });
        if is_singular {
            drop_mean(field, plane_len);
        }
        let scale = self.spacing_squared / (x.gain * y.gain);
        for_each_chunk_pair(blocks, blocks_per_task * block_len, scratch, 1, |task, blocks, scratch| {
            for (block, n) in blocks.chunks_exact_mut(block_len).zip(task * blocks_per_task..) {
                let (rows, _) = block.as_chunks_mut();
                columns::gather(field, plane_len, n * WIDTH, scale, rows);
                let lambda = self.eigenvalues[n].map(|eigenvalue| self.spacing_squared * (shift + eigenvalue));
                columns::solve(self.along_z, &lambda, rows, &mut scratch[0].columns);
            }
        });
        if is_singular {
            drop_mean(&mut blocks[..block_len], WIDTH);
        }
        for_each_chunk_pair(field, planes_per_task * plane_len, scratch, 1, |task, planes, scratch| {
            for (n, block) in blocks.chunks_exact(block_len).enumerate() {
                let (rows, _) = block.as_chunks();
                columns::scatter(&rows[task * planes_per_task..], planes, plane_len, n * WIDTH);
            }
            planes.chunks_exact_mut(plane_len).for_each(|plane| plane::from_modes(x, y, plane, &mut scratch[0].lines));
        });
    }
}

/// Subtracts from every `stride`-th value, starting with the first, the mean of these values.
fn drop_mean(values: &mut [f64], stride: usize) {
    let sum: f64 = values.iter().step_by(stride).sum();
    let mean = sum / values.len().div_ceil(stride) as f64;
    values.iter_mut().step_by(stride).for_each(|value| *value -= mean);
}
