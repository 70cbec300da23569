//! A scalar field on the grid, and the three that make a velocity.

use super::sample::{self, Stencil};
use super::{Grid, Place, Real};

/// One number per cell or per face of a [`Grid`].
#[derive(Clone, Debug, PartialEq)]
pub struct Field<R> {
    /// Where on a cell the values live.
    pub place: Place,
    /// Number of values along x, y and z.
    pub shape: [usize; 3],
    /// The values, x fastest, then y, then z.
    pub data: Vec<R>,
}

impl<R: Real> Field<R> {
    /// A field of zeros at `place`.
    pub fn zeros(grid: &Grid<R>, place: Place) -> Self {
        let shape = grid.shape(place);
        Self { place, shape, data: vec![R::zero(); shape.iter().product()] }
    }

    /// Where value (i, j, k) lies in [`Field::data`].
    #[inline(always)]
    pub fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        i + self.shape[0] * (j + self.shape[1] * k)
    }

    /// Number of values with the same k.
    #[inline(always)]
    pub fn plane_len(&self) -> usize {
        self.shape[0] * self.shape[1]
    }

    /// Sets every value to `f` of its position (m).
    pub fn fill(&mut self, grid: &Grid<R>, f: impl Fn([R; 3]) -> R) {
        let [nx, ny, _] = self.shape;
        for (at, value) in self.data.iter_mut().enumerate() {
            *value = f(grid.position_m(self.place, [at % nx, at / nx % ny, at / (nx * ny)]));
        }
    }

    /// Trilinear value at a position (m). Wrapped axes repeat; beyond the outermost values of a walled axis the nearest one holds.
    ///
    /// Exact for fields linear in each coordinate; otherwise within `Σ h²·max|∂²f|/8`.
    pub fn at(&self, grid: &Grid<R>, position_m: [R; 3]) -> R {
        let stencils: [Stencil<R>; 3] = std::array::from_fn(|axis| {
            let along = position_m[axis] / grid.spacing_m[axis] - grid.offset(self.place, axis);
            Stencil::new(0, along, self.shape[axis], grid.wraps(axis))
        });
        sample::trilinear(&self.data, self.shape, &stencils)
    }
}

/// A staggered velocity (m/s): component `a` lives on the faces across axis `a`.
#[derive(Clone, Debug, PartialEq)]
pub struct Velocity<R>(pub [Field<R>; 3]);

impl<R: Real> Velocity<R> {
    /// Air at rest.
    pub fn zeros(grid: &Grid<R>) -> Self {
        Self(std::array::from_fn(|axis| Field::zeros(grid, Place::Face(axis))))
    }
}
