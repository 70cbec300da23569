//! The box of cells: shapes, spacing, boundaries, and where on a cell a value lives.

use super::Real;

/// What the two faces of the box across one axis do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Boundary {
    /// What leaves through one face comes in through the opposite one.
    Wrap,
    /// No flow through the face, and no friction along it (free slip).
    Wall,
}

/// Where on a cell the values of a field live.
///
/// The grid is staggered (Harlow & Welch, Phys. Fluids 8, 1965): pressure and dust at the centres of cells, each velocity component on the faces
/// it flows through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The centre of the cell.
    Centre,
    /// The face towards smaller coordinates, across axis 0 (x), 1 (y) or 2 (z).
    Face(usize),
}

/// A box of `cells[0] × cells[1] × cells[2]` cells with one corner at the origin; x is fastest in memory, then y, then z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid<R> {
    /// Number of cells along x, y and z; each at least 1.
    pub cells: [usize; 3],
    /// Size of a cell along x, y and z (m).
    pub spacing_m: [R; 3],
    /// What the faces across x, y and z do.
    pub boundary: [Boundary; 3],
}

impl<R: Real> Grid<R> {
    /// Number of cells.
    pub fn len(&self) -> usize {
        self.cells.iter().product()
    }

    /// True for a grid without cells.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// True where the box is joined to itself across `axis`.
    #[inline(always)]
    pub fn wraps(&self, axis: usize) -> bool {
        self.boundary[axis] == Boundary::Wrap
    }

    /// How many values a field at `place` has along each axis. A walled axis has a face more than cells; on a wrapped one the last face is the first.
    ///
    /// ```
    /// use server::wind::{Boundary::*, Grid, Place};
    /// let grid = Grid { cells: [4, 4, 4], spacing_m: [1.0f32; 3], boundary: [Wrap, Wall, Wrap] };
    /// assert_eq!(grid.shape(Place::Face(0)), [4, 4, 4]);
    /// assert_eq!(grid.shape(Place::Face(1)), [4, 5, 4]);
    /// ```
    pub fn shape(&self, place: Place) -> [usize; 3] {
        let mut shape = self.cells;
        if let Place::Face(axis) = place
            && !self.wraps(axis)
        {
            shape[axis] += 1;
        }
        shape
    }

    /// Offset of a value from the low corner of its cell, in cells along `axis`.
    ///
    /// ```
    /// use server::wind::{Boundary::*, Grid, Place};
    /// let grid = Grid { cells: [4, 4, 4], spacing_m: [2.0f32; 3], boundary: [Wrap; 3] };
    /// assert_eq!([0, 1, 2].map(|axis| grid.offset(Place::Face(0), axis)), [0.0, 0.5, 0.5]);
    /// assert_eq!(grid.position_m(Place::Face(0), [1, 0, 0]), [2.0, 1.0, 1.0]);
    /// assert_eq!(grid.position_m(Place::Centre, [1, 0, 0]), [3.0, 1.0, 1.0]);
    /// ```
    #[inline(always)]
    pub fn offset(&self, place: Place, axis: usize) -> R {
        if place == Place::Face(axis) { R::zero() } else { R::of(0.5) }
    }

    /// Position (m) of value `index` of a field at `place`.
    pub fn position_m(&self, place: Place, index: [usize; 3]) -> [R; 3] {
        std::array::from_fn(|axis| (R::of(index[axis] as f64) + self.offset(place, axis)) * self.spacing_m[axis])
    }

    /// Extent of the box along `axis` (m).
    pub fn extent_m(&self, axis: usize) -> R {
        R::of(self.cells[axis] as f64) * self.spacing_m[axis]
    }

    /// Index of the neighbour of cell `i` towards smaller coordinates along `axis`; at a wall the cell itself.
    #[inline(always)]
    pub fn below(&self, axis: usize, i: usize) -> usize {
        match (i, self.boundary[axis]) {
            (0, Boundary::Wrap) => self.cells[axis] - 1,
            (0, Boundary::Wall) => 0,
            _ => i - 1,
        }
    }

    /// Index of the face of cell `i` towards larger coordinates along `axis`, in a field at [`Place::Face`]`(axis)`.
    #[inline(always)]
    pub fn far_face(&self, axis: usize, i: usize) -> usize {
        if i + 1 == self.cells[axis] && self.wraps(axis) { 0 } else { i + 1 }
    }
}
