//! Staggered grid: shapes, spacing, memory layout and locations of values.

use std::ops::Range;

use super::boundary::condition::Boundary;
use super::real::Real;

/// Layers of ghost values beyond every face of the box, filled by the boundary conditions.
pub const GHOST: usize = 2;

/// Location of the values of a field on a cell.
///
/// The grid is staggered (Harlow & Welch, Phys. Fluids 8, 1965): pressure and dust at cell centres, each velocity component on the faces normal to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Location {
    /// The centre of the cell.
    Centre,
    /// The face towards smaller coordinates, normal to axis 0 (x), 1 (y) or 2 (z).
    Face(usize),
}

/// A box of `cells[0] × cells[1] × cells[2]` cells with one corner at the origin; x is fastest in memory, then y, then z.
///
/// All fields of a grid have the same memory layout, whatever their location: along each axis [`GHOST`] layers, the cells, the last face and
/// [`GHOST`] more layers.
/// The value that belongs to cell (i, j, k) thus has the same index in every field, and neighbours along an axis are [`Grid::strides`] apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid<R> {
    /// Number of cells along x, y and z; each at least 1.
    pub cells: [usize; 3],
    /// Size of a cell along x, y and z (m).
    pub spacing_m: [R; 3],
    /// Boundary conditions at the lower and upper face across x, y and z.
    pub boundary: [[Boundary; 2]; 3],
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

    /// Distance in memory from a value to the next one along x, y and z.
    #[inline(always)]
    pub fn strides(&self) -> [usize; 3] {
        let [nx, ny, _] = self.padded();
        [1, nx, nx * ny]
    }

    /// Number of values along x, y and z in memory, ghosts included.
    #[inline(always)]
    pub fn padded(&self) -> [usize; 3] {
        self.cells.map(|n| n + 2 * GHOST + 1)
    }

    /// Length of a field in memory, ghosts included.
    pub fn padded_len(&self) -> usize {
        self.padded().iter().product()
    }

    /// Index in memory of the value of cell (i, j, k); the last face along an axis belongs to cell n.
    #[inline(always)]
    pub fn at(&self, [i, j, k]: [usize; 3]) -> usize {
        let [_, sy, sz] = self.strides();
        i + GHOST + sy * (j + GHOST) + sz * (k + GHOST)
    }

    /// Whether the box is periodic along `axis`.
    #[inline(always)]
    pub fn wraps(&self, axis: usize) -> bool {
        self.boundary[axis][0] == Boundary::Wrap
    }

    /// Number of values of a field at `location` along each axis. Non-periodic axes have one more face than cells; on periodic ones the last face
    /// equals the first.
    ///
    /// ```
    /// use prairie_wind::{Boundary::*, Grid, Location};
    /// let grid = Grid { cells: [4; 3], spacing_m: [1.0f32; 3], boundary: [[Wrap; 2], [NoSlip, FreeSlip], [Wrap; 2]] };
    /// assert_eq!(grid.shape(Location::Face(0)), [4, 4, 4]);
    /// assert_eq!(grid.shape(Location::Face(1)), [4, 5, 4]);
    /// ```
    pub fn shape(&self, location: Location) -> [usize; 3] {
        let mut shape = self.cells;
        if let Location::Face(axis) = location
            && !self.wraps(axis)
        {
            shape[axis] += 1;
        }
        shape
    }

    /// Interior values along `axis` of a field at `location`: unknowns of the flow, not given by a boundary condition.
    #[inline(always)]
    pub fn free(&self, location: Location, axis: usize) -> Range<usize> {
        let n = self.cells[axis];
        if location != Location::Face(axis) || self.wraps(axis) {
            return 0..n;
        }
        let [low, high] = self.boundary[axis].map(|face| usize::from(face.fixes_pressure()));
        1 - low..n + high
    }

    /// Values along `axis` of a field at `location` between two cells, or in one: [`Grid::free`] without the faces of outflows.
    pub(super) fn inner(&self, location: Location, axis: usize) -> Range<usize> {
        let n = self.cells[axis];
        if location != Location::Face(axis) || self.wraps(axis) { 0..n } else { 1..n }
    }

    /// Offset of a value from the low corner of its cell, in cells along `axis`.
    ///
    /// ```
    /// use prairie_wind::{Boundary::*, Grid, Location};
    /// let grid = Grid { cells: [4; 3], spacing_m: [2.0f32; 3], boundary: [[Wrap; 2]; 3] };
    /// assert_eq!([0, 1, 2].map(|axis| grid.offset(Location::Face(0), axis)), [0.0, 0.5, 0.5]);
    /// assert_eq!(grid.position_m(Location::Face(0), [1, 0, 0]), [2.0, 1.0, 1.0]);
    /// assert_eq!(grid.position_m(Location::Centre, [1, 0, 0]), [3.0, 1.0, 1.0]);
    /// ```
    #[inline(always)]
    pub fn offset(&self, location: Location, axis: usize) -> R {
        if location == Location::Face(axis) { R::zero() } else { R::of(0.5) }
    }

    /// Position (m) of value `index` of a field at `location`.
    pub fn position_m(&self, location: Location, index: [usize; 3]) -> [R; 3] {
        std::array::from_fn(|axis| (R::of(index[axis] as f64) + self.offset(location, axis)) * self.spacing_m[axis])
    }

    /// Extent of the box along `axis` (m).
    pub fn extent_m(&self, axis: usize) -> R {
        R::of(self.cells[axis] as f64) * self.spacing_m[axis]
    }
}
