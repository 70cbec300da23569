//! The box of cells: shapes, spacing, boundaries, and where on a cell a value lives.

use std::ops::Range;

use super::Real;

/// Layers of values kept beyond every face of the box, which the boundary fills in.
pub const GHOST: usize = 2;

/// What a face of the box does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Boundary {
    /// What leaves through this face comes in through the opposite one, which wraps too (000 §2.3.7).
    Wrap,
    /// No flow through the face and no friction along it (000 §2.3.7: zero normal velocity).
    FreeSlip,
    /// The air beyond the face is its mirror image (000 §2.3.7: the velocity reverses). On the staggered grid, where the normal velocity lives on the face
    /// itself, this has the values of [`Boundary::FreeSlip`]; in the collocated method of 000 the two differ.
    Reflect,
    /// Air sticks to the face.
    NoSlip,
    /// Air sticks to the face, which moves along itself at this velocity (m/s).
    Lid {
        /// Velocity (m/s); the component across the face is 0.
        velocity_m_per_s: [f32; 3],
    },
    /// Air has a velocity prescribed as a function of place and time: see [`Solver::prescribe`](super::Solver::prescribe); without one the mean wind. Dust
    /// does not come in.
    Inflow,
    /// Pressure is 0 on the face, and nothing changes across it.
    Outflow,
}

impl Boundary {
    /// True where nothing passes through the face.
    pub fn is_closed(self) -> bool {
        matches!(self, Self::FreeSlip | Self::Reflect | Self::NoSlip | Self::Lid { .. })
    }

    /// True where the velocity along the face is given on it, rather than free.
    pub fn holds_air(self) -> bool {
        matches!(self, Self::NoSlip | Self::Lid { .. } | Self::Inflow)
    }
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
///
/// All fields of a grid, whatever their place, lie alike in memory: [`GHOST`] layers, the cells, the face beyond the last one and [`GHOST`] more layers along
/// each axis. So the value that belongs to cell (i, j, k) has the same index in each, and one cell along an axis is always the same [`Grid::strides`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid<R> {
    /// Number of cells along x, y and z; each at least 1.
    pub cells: [usize; 3],
    /// Size of a cell along x, y and z (m).
    pub spacing_m: [R; 3],
    /// What the faces towards smaller and larger coordinates across x, y and z do.
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

    /// Where the value of cell (i, j, k) lies in a field; the face beyond the last cell is that of cell n.
    #[inline(always)]
    pub fn at(&self, [i, j, k]: [usize; 3]) -> usize {
        let [_, sy, sz] = self.strides();
        i + GHOST + sy * (j + GHOST) + sz * (k + GHOST)
    }

    /// True where the box is joined to itself across `axis`.
    #[inline(always)]
    pub fn wraps(&self, axis: usize) -> bool {
        self.boundary[axis][0] == Boundary::Wrap
    }

    /// How many values a field at `place` has along each axis. Across faces that do not wrap there is a face more than cells; on a wrapped axis the last
    /// face is the first.
    ///
    /// ```
    /// use server::wind::{Boundary::*, Grid, Place};
    /// let grid = Grid { cells: [4; 3], spacing_m: [1.0f32; 3], boundary: [[Wrap; 2], [NoSlip, FreeSlip], [Wrap; 2]] };
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

    /// The values along `axis` of a field at `place` that the flow decides: all but those the boundary gives.
    #[inline(always)]
    pub fn free(&self, place: Place, axis: usize) -> Range<usize> {
        let n = self.cells[axis];
        if place != Place::Face(axis) || self.wraps(axis) {
            return 0..n;
        }
        let [low, high] = self.boundary[axis].map(|face| usize::from(face == Boundary::Outflow));
        1 - low..n + high
    }

    /// Offset of a value from the low corner of its cell, in cells along `axis`.
    ///
    /// ```
    /// use server::wind::{Boundary::*, Grid, Place};
    /// let grid = Grid { cells: [4; 3], spacing_m: [2.0f32; 3], boundary: [[Wrap; 2]; 3] };
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
}
