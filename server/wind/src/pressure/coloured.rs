//! Red–black (checkerboard) storage of a field: all neighbours of a cell have the other colour.
//!
//! With a layer of ghosts around the box and odd strides, the parity of a cell's padded linear index `l = x + stride_y·y + stride_z·z` is its colour
//! and `l / 2` its position in that colour's array. Neighbour offsets are then the same for every cell of a colour, and kernels run over whole planes
//! in one contiguous loop, including ghosts, whose coefficients are 0.

use std::ops::Range;

use super::super::Real;
use super::super::parallel::{for_each_chunk, for_each_chunk_pair};

/// A value for each cell and ghost, split into red (even) and black (odd).
pub(super) type Coloured<R> = [Vec<R>; 2];

/// Layout of a [`Coloured`] field. Padded coordinates are 1 to `cells` inside the box; ghosts are at 0 and `cells + 1`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    pub(super) cells: [usize; 3],
    pub(super) wraps: [bool; 3],
    /// Strides of the linear index along each axis, all odd.
    pub(super) stride: [usize; 3],
}

impl Layout {
    pub(super) fn new(cells: [usize; 3], wraps: [bool; 3]) -> Self {
        let row = (cells[0] + 2) | 1;
        let plane = row * ((cells[1] + 2) | 1);
        Self { cells, wraps, stride: [1, row, plane] }
    }

    /// Padded linear index of a cell.
    #[inline(always)]
    pub(super) fn linear(&self, [x, y, z]: [usize; 3]) -> usize {
        x + self.stride[1] * y + self.stride[2] * z
    }

    /// Number of chunks of parallel work, each a pair of planes: two planes hold as many red values as black ones.
    pub(super) fn chunks(&self) -> usize {
        (self.cells[2] + 2).div_ceil(2)
    }

    /// Values in one chunk of one colour.
    pub(super) fn chunk_len(&self) -> usize {
        self.stride[2]
    }

    /// Number of linear indices: the length of an array of all ghosts and cells in natural order.
    pub(super) fn padded_len(&self) -> usize {
        2 * self.chunk_len() * self.chunks()
    }

    pub(super) fn zeros<R: Clone + Default>(&self) -> Coloured<R> {
        [vec![R::default(); self.chunk_len() * self.chunks()], vec![R::default(); self.chunk_len() * self.chunks()]]
    }

    /// Padded coordinates of all cells, x fastest.
    pub(super) fn coordinates(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        let [nx, ny, nz] = self.cells;
        (1..=nz).flat_map(move |z| (1..=ny).flat_map(move |y| (1..=nx).map(move |x| [x, y, z])))
    }

    /// Positions of the cells of `colour` among the linear indices `from..to`.
    fn positions(colour: usize, from: usize, to: usize) -> Range<usize> {
        (from + 1 - colour) / 2..(to + 1 - colour) / 2
    }

    /// Positions of the cells of a colour in plane `z` (1 to `cells[2]`), including the ghosts at the ends of rows.
    fn plane(&self, colour: usize, z: usize) -> Range<usize> {
        Self::positions(colour, self.linear([0, 1, z]), self.linear([0, self.cells[1] + 1, z]))
    }

    /// Planes of the box in a chunk.
    pub(super) fn planes(&self, chunk: usize) -> impl Iterator<Item = usize> + use<> {
        (2 * chunk).max(1)..(2 * chunk + 2).min(self.cells[2] + 1)
    }

    /// Calls `f(position of the first value, values)` for each plane of one colour's array.
    pub(super) fn for_each_plane<T: Send>(&self, colour: usize, data: &mut [T], f: impl Fn(usize, &mut [T]) + Sync + Send) {
        for_each_chunk(data, self.chunk_len(), |chunk, values| {
            let start = chunk * self.chunk_len();
            for z in self.planes(chunk) {
                let plane = self.plane(colour, z);
                f(plane.start, &mut values[plane.start - start..plane.end - start]);
            }
        });
    }

    /// Like [`for_each_plane`](Self::for_each_plane), but sums the results of `f`, in the same order on any number of threads. `partial` has one
    /// value per chunk.
    pub(super) fn sum_planes<T: Send>(
        &self,
        colour: usize,
        data: &mut [T],
        partial: &mut [f64],
        f: impl Fn(usize, &mut [T]) -> f64 + Sync + Send,
    ) -> f64 {
        for_each_chunk_pair(data, self.chunk_len(), partial, 1, |chunk, values, sum| {
            let start = chunk * self.chunk_len();
            sum[0] = self
                .planes(chunk)
                .map(|z| {
                    let plane = self.plane(colour, z);
                    f(plane.start, &mut values[plane.start - start..plane.end - start])
                })
                .sum();
        });
        partial.iter().sum()
    }

    /// Offsets in position from a cell of `colour` to its neighbours along an axis: back to the lower one, forward to the upper one.
    #[inline(always)]
    pub(super) fn steps(&self, colour: usize, axis: usize) -> [usize; 2] {
        [self.stride[axis].div_ceil(2) - colour, self.stride[axis] / 2 + colour]
    }

    /// True if a periodic axis has an odd number of cells, which makes two cells of one colour neighbours.
    pub(super) fn seams(&self) -> bool {
        (0..3).any(|axis| self.wraps[axis] && self.cells[axis] % 2 == 1)
    }

    /// Refreshes the ghosts of all periodic axes after cells of both colours have changed.
    pub(super) fn wrap<R: Copy>(&self, field: &mut Coloured<R>) {
        (0..2).for_each(|colour| self.wrap_ghosts(colour, field));
    }

    /// Refreshes the ghosts that copy cells of `colour`, after these have changed: ghosts of the same colour and, at seams, of the other.
    pub(super) fn wrap_after<R: Copy>(&self, colour: usize, field: &mut Coloured<R>) {
        self.wrap_ghosts(colour, field);
        if self.seams() {
            self.wrap_ghosts(1 - colour, field);
        }
    }

    /// Copies the cells at each end of the periodic axes to the ghosts of `colour` at the other end.
    fn wrap_ghosts<R: Copy>(&self, colour: usize, field: &mut Coloured<R>) {
        let [nx, ny, nz] = self.cells;
        for (axis, shift) in [nx, ny * self.stride[1], nz * self.stride[2]].into_iter().enumerate().filter(|&(axis, _)| self.wraps[axis]) {
            // Runs of contiguous ghosts: single cells, rows, planes.
            let (rows, planes) = ([1..ny + 1, 0..1, 0..1][axis].clone(), [1..nz + 1, 1..nz + 1, 0..1][axis].clone());
            for (z, y) in planes.flat_map(|z| rows.clone().map(move |y| (z, y))) {
                let low = self.linear([0, y, z]);
                let high = low + shift + self.stride[axis];
                for (ghost, source) in [(low, low + shift), (high, high - shift)] {
                    let to = Self::positions(colour, ghost, ghost + self.stride[axis]);
                    let Some(len) = to.end.checked_sub(to.start).filter(|&len| len > 0) else { continue };
                    // The first ghost of this colour, and the cell it copies.
                    let first = 2 * to.start + colour - ghost + source;
                    let from = first / 2;
                    if first % 2 == colour {
                        field[colour].copy_within(from..from + len, to.start);
                    } else {
                        let [red, black] = field;
                        let (own, other) = if colour == 0 { (red, black) } else { (black, red) };
                        own[to].copy_from_slice(&other[from..from + len]);
                    }
                }
            }
        }
    }

    /// Copies an array without ghosts, x fastest, into the box.
    pub(super) fn load<R: Copy, S: Real>(&self, natural: &[R], field: &mut Coloured<S>, convert: impl Fn(R) -> S) {
        for (row, values) in natural.chunks_exact(self.cells[0]).enumerate() {
            let (y, z) = (1 + row % self.cells[1], 1 + row / self.cells[1]);
            let start = self.linear([1, y, z]);
            for (first, parity) in [(0, start % 2), (1, (start + 1) % 2)] {
                let to = &mut field[parity][(start + first) / 2..];
                to.iter_mut().zip(values.iter().skip(first).step_by(2)).for_each(|(to, &from)| *to = convert(from));
            }
        }
    }

    /// Copies the box to an array without ghosts, x fastest.
    pub(super) fn store<R: Copy>(&self, field: &Coloured<R>, natural: &mut [R]) {
        for (row, values) in natural.chunks_exact_mut(self.cells[0]).enumerate() {
            let (y, z) = (1 + row % self.cells[1], 1 + row / self.cells[1]);
            let start = self.linear([1, y, z]);
            for (first, parity) in [(0, start % 2), (1, (start + 1) % 2)] {
                let from = &field[parity][(start + first) / 2..];
                values.iter_mut().skip(first).step_by(2).zip(from).for_each(|(to, &from)| *to = from);
            }
        }
    }
}

/// The array of one colour, mutable, and that of the other.
#[inline(always)]
pub(super) fn apart<R>(field: &mut Coloured<R>, colour: usize) -> (&mut [R], &[R]) {
    let [red, black] = field;
    if colour == 0 { (red, black) } else { (black, red) }
}

/// Value at a padded linear index.
#[inline(always)]
pub(super) fn at<R: Copy>(field: &Coloured<R>, linear: usize) -> R {
    field[linear % 2][linear / 2]
}

/// Sets the value at a padded linear index.
#[inline(always)]
pub(super) fn set<R>(field: &mut Coloured<R>, linear: usize, value: R) {
    field[linear % 2][linear / 2] = value;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_in_the_other_colour_where_the_steps_say() {
        let layout = Layout::new([4, 3, 5], [false; 3]);
        for cell in layout.coordinates() {
            let l = layout.linear(cell);
            for axis in 0..3 {
                let [back, on] = layout.steps(l % 2, axis);
                let (below, above) = (l - layout.stride[axis], l + layout.stride[axis]);
                assert_eq!((below % 2, below / 2), (1 - l % 2, l / 2 - back));
                assert_eq!((above % 2, above / 2), (1 - l % 2, l / 2 + on));
            }
        }
    }

    #[test]
    fn ghosts_repeat_the_other_end() {
        for cells in [[4, 3, 5], [1, 2, 6], [2, 2, 2], [5, 1, 1]] {
            let layout = Layout::new(cells, [true; 3]);
            let natural: Vec<f64> = (1..=cells.iter().product()).map(|i| i as f64).collect();
            let mut field = layout.zeros();
            layout.load(&natural, &mut field, |v| v);
            layout.wrap(&mut field);
            for axis in 0..3 {
                for mut cell in layout.coordinates().filter(|cell| cell[axis] == 1) {
                    let (first, beyond) = (layout.linear(cell), layout.linear(cell) - layout.stride[axis]);
                    cell[axis] = cells[axis];
                    let (last, after) = (layout.linear(cell), layout.linear(cell) + layout.stride[axis]);
                    assert_eq!((at(&field, beyond), at(&field, after)), (at(&field, last), at(&field, first)));
                }
            }
            let mut back = vec![0.0; natural.len()];
            layout.store(&field, &mut back);
            assert_eq!(back, natural);
        }
    }
}
