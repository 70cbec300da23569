//! Scalar fields and staggered velocities.

use super::sample::{self, Stencil};
use super::{GHOST, Grid, Location, Real};

/// A scalar field at one location of a [`Grid`], with its ghosts.
#[derive(Clone, Debug, PartialEq)]
pub struct Field<R> {
    /// Location of the values on a cell.
    pub location: Location,
    /// Number of values along x, y and z, without ghosts.
    pub shape: [usize; 3],
    /// The values in memory order, ghosts included: value (i, j, k) is at [`Grid::at`].
    pub data: Vec<R>,
}

impl<R: Real> Field<R> {
    /// A field of zeros at `location`.
    pub fn zeros(grid: &Grid<R>, location: Location) -> Self {
        Self { location, shape: grid.shape(location), data: vec![R::zero(); grid.padded_len()] }
    }

    /// Index in [`Field::data`] of the first value of every row along x, rows in memory order, without ghosts.
    pub fn rows(&self, grid: &Grid<R>) -> impl Iterator<Item = usize> + use<R> {
        let (grid, [_, ny, nz]) = (*grid, self.shape);
        (0..nz).flat_map(move |k| (0..ny).map(move |j| grid.at([0, j, k])))
    }

    /// The values without ghosts, x fastest, then y, then z.
    pub fn values(&self, grid: &Grid<R>) -> impl Iterator<Item = R> + '_ {
        self.rows(grid).flat_map(|row| self.data[row..][..self.shape[0]].iter().copied())
    }

    /// Sets the values without ghosts, in the order of [`Field::values`].
    pub fn set_values(&mut self, grid: &Grid<R>, values: &[R]) {
        for (row, values) in self.rows(grid).zip(values.chunks(self.shape[0])) {
            self.data[row..][..self.shape[0]].copy_from_slice(values);
        }
    }

    /// Number of values without ghosts.
    pub fn len(&self) -> usize {
        self.shape.iter().product()
    }

    /// Whether the field has no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Values with their positions (m), in the order of [`Field::values`].
    pub fn samples(&self, grid: &Grid<R>) -> impl Iterator<Item = ([R; 3], R)> + '_ {
        let (grid, [nx, ny, _]) = (*grid, self.shape);
        self.values(&grid)
            .enumerate()
            .map(move |(n, value)| (grid.position_m(self.location, [n % nx, n / nx % ny, n / (nx * ny)]), value))
            .collect::<Vec<_>>()
            .into_iter()
    }

    /// Sets every value to `f` of its position (m), except ghosts.
    pub fn fill(&mut self, grid: &Grid<R>, f: impl Fn([R; 3]) -> R) {
        for k in 0..self.shape[2] {
            for j in 0..self.shape[1] {
                for i in 0..self.shape[0] {
                    self.data[grid.at([i, j, k])] = f(grid.position_m(self.location, [i, j, k]));
                }
            }
        }
    }

    /// Trilinear interpolation at a position (m). Periodic axes repeat; beyond other faces the value is that on the face. Ghosts must be filled.
    ///
    /// Exact for fields linear in each coordinate; otherwise within `Σ h²·max|∂²f|/8`.
    pub fn at(&self, grid: &Grid<R>, position_m: [R; 3]) -> R {
        let stencils: [Stencil<R>; 3] = std::array::from_fn(|axis| {
            let along = position_m[axis] / grid.spacing_m[axis] - grid.offset(self.location, axis);
            Stencil::new(0, along, sample::Ends::of(grid, self.location, axis))
        });
        sample::trilinear(&self.data, grid.strides(), &stencils)
    }
}

/// Calls `f(k, plane)` for each plane of padded values whose k is in `planes`, on all threads for large fields.
pub(super) fn for_each_plane<R: Real, T: Send>(
    grid: &Grid<R>,
    planes: std::ops::Range<usize>,
    data: &mut [T],
    f: impl Fn(usize, &mut [T]) + Sync + Send,
) {
    let plane_len = grid.strides()[2];
    let inner = &mut data[plane_len * (planes.start + GHOST)..plane_len * (planes.end + GHOST)];
    super::parallel::for_each_chunk(inner, plane_len, |n, plane| f(planes.start + n, plane));
}

/// A staggered velocity (m/s): component `a` is located on the faces normal to axis `a`.
#[derive(Clone, Debug, PartialEq)]
pub struct Velocity<R>(pub [Field<R>; 3]);

impl<R: Real> Velocity<R> {
    /// Air at rest.
    pub fn zeros(grid: &Grid<R>) -> Self {
        Self(std::array::from_fn(|axis| Field::zeros(grid, Location::Face(axis))))
    }

    /// Copies another velocity of the same grid, including ghosts.
    pub fn copy_from(&mut self, other: &Self) {
        for (field, other) in self.0.iter_mut().zip(&other.0) {
            field.data.copy_from_slice(&other.data);
        }
    }
}
