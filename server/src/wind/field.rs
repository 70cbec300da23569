//! A scalar field on the grid, and the three that make a velocity.

use super::sample::{self, Stencil};
use super::{GHOST, Grid, Place, Real};

/// One number per cell or per face of a [`Grid`], with its ghosts.
#[derive(Clone, Debug, PartialEq)]
pub struct Field<R> {
    /// Where on a cell the values live.
    pub place: Place,
    /// Number of values along x, y and z, without ghosts.
    pub shape: [usize; 3],
    /// The values in memory order, ghosts included: value (i, j, k) is at [`Grid::at`].
    pub data: Vec<R>,
}

impl<R: Real> Field<R> {
    /// A field of zeros at `place`.
    pub fn zeros(grid: &Grid<R>, place: Place) -> Self {
        Self { place, shape: grid.shape(place), data: vec![R::zero(); grid.padded_len()] }
    }

    /// Index in [`Field::data`] of the first value of every row along x, rows in memory order, ghosts left out.
    pub fn rows(&self, grid: &Grid<R>) -> impl Iterator<Item = usize> + use<R> {
        let (grid, [_, ny, nz]) = (*grid, self.shape);
        (0..nz).flat_map(move |k| (0..ny).map(move |j| grid.at([0, j, k])))
    }

    /// The values without ghosts, x fastest, then y, then z.
    pub fn values(&self, grid: &Grid<R>) -> impl Iterator<Item = R> + '_ {
        self.rows(grid).flat_map(|row| self.data[row..][..self.shape[0]].iter().copied())
    }

    /// Sets the values without ghosts from as many others in the order of [`Field::values`].
    pub fn set_values(&mut self, grid: &Grid<R>, values: &[R]) {
        for (row, values) in self.rows(grid).zip(values.chunks(self.shape[0])) {
            self.data[row..][..self.shape[0]].copy_from_slice(values);
        }
    }

    /// Number of values without ghosts.
    pub fn len(&self) -> usize {
        self.shape.iter().product()
    }

    /// True for a field without values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Values with their positions (m), in the order of [`Field::values`].
    pub fn samples(&self, grid: &Grid<R>) -> impl Iterator<Item = ([R; 3], R)> + '_ {
        let (grid, [nx, ny, _]) = (*grid, self.shape);
        self.values(&grid)
            .enumerate()
            .map(move |(n, value)| (grid.position_m(self.place, [n % nx, n / nx % ny, n / (nx * ny)]), value))
            .collect::<Vec<_>>()
            .into_iter()
    }

    /// Sets every value to `f` of its position (m); ghosts are left to the boundary.
    pub fn fill(&mut self, grid: &Grid<R>, f: impl Fn([R; 3]) -> R) {
        for k in 0..self.shape[2] {
            for j in 0..self.shape[1] {
                for i in 0..self.shape[0] {
                    self.data[grid.at([i, j, k])] = f(grid.position_m(self.place, [i, j, k]));
                }
            }
        }
    }

    /// Trilinear value at a position (m). Wrapped axes repeat; beyond other faces the value on the face holds. Ghosts must be filled.
    ///
    /// Exact for fields linear in each coordinate; otherwise within `Σ h²·max|∂²f|/8`.
    pub fn at(&self, grid: &Grid<R>, position_m: [R; 3]) -> R {
        let stencils: [Stencil<R>; 3] = std::array::from_fn(|axis| {
            let along = position_m[axis] / grid.spacing_m[axis] - grid.offset(self.place, axis);
            Stencil::new(0, along, sample::Ends::of(grid, self.place, axis))
        });
        sample::trilinear(&self.data, grid.strides(), &stencils)
    }
}

/// Calls `f(k, plane)` for each plane of padded values whose k is in `planes`, on all threads where that pays.
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

/// A staggered velocity (m/s): component `a` lives on the faces across axis `a`.
#[derive(Clone, Debug, PartialEq)]
pub struct Velocity<R>(pub [Field<R>; 3]);

impl<R: Real> Velocity<R> {
    /// Air at rest.
    pub fn zeros(grid: &Grid<R>) -> Self {
        Self(std::array::from_fn(|axis| Field::zeros(grid, Place::Face(axis))))
    }

    /// Takes on the values of another velocity of the same grid, ghosts and all.
    pub fn copy_from(&mut self, other: &Self) {
        for (field, other) in self.0.iter_mut().zip(&other.0) {
            field.data.copy_from_slice(&other.data);
        }
    }
}
