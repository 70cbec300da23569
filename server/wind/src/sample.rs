//! Trilinear interpolation between values of a field with ghosts.

use super::{GHOST, Grid, Location, Real};

/// Range of the values along an axis.
#[derive(Clone, Copy, Debug)]
pub struct Ends<R> {
    n: isize,
    wraps: bool,
    /// Coordinates (cells) of the faces of the box; points beyond are clamped to them on a non-periodic axis.
    held: [R; 2],
}

impl<R: Real> Ends<R> {
    /// The ends along `axis` of a field at `location`.
    #[inline(always)]
    pub fn of(grid: &Grid<R>, location: Location, axis: usize) -> Self {
        let n = grid.cells[axis];
        let offset = grid.offset(location, axis);
        Self { n: n as isize, wraps: grid.wraps(axis), held: [-offset, R::of(n as f64) - offset] }
    }
}

/// Interpolation stencil along one axis: the value below a point, and the point's fraction of the distance to the next.
#[derive(Clone, Copy, Debug)]
pub struct Stencil<R> {
    /// Index in memory along the axis of the lower value, including ghosts.
    pub near: usize,
    /// 0 at `near`, 1 at the next.
    pub fraction: R,
}

impl<R: Real> Stencil<R> {
    /// The stencil of the point `shift` cells from index `i`, at any distance: wrapped on a periodic axis, otherwise clamped to the faces of the box.
    #[inline(always)]
    pub fn new(i: usize, shift: R, ends: Ends<R>) -> Self {
        let (floor, fraction) = shift.split();
        let near = (i as isize).saturating_add(floor);
        if near >= 0 && near < ends.n - 1 {
            return Self { near: near as usize + GHOST, fraction };
        }
        Self::at_the_end(near, fraction, ends)
    }

    #[cold]
    fn at_the_end(near: isize, fraction: R, ends: Ends<R>) -> Self {
        if ends.wraps {
            return Self { near: near.rem_euclid(ends.n) as usize + GHOST, fraction };
        }
        let [low, high] = ends.held;
        let coordinate = R::of(near as f64) + fraction;
        if coordinate > low && coordinate < high {
            return Self { near: (near + GHOST as isize) as usize, fraction };
        }
        let (floor, fraction) = if coordinate <= low { low } else { high }.split();
        Self { near: (floor + GHOST as isize) as usize, fraction }
    }
}

/// A value that can be interpolated linearly.
pub trait Blend<R>: Copy {
    /// `self` at `t = 0`, `other` at `t = 1`.
    fn blend(self, other: Self, t: R) -> Self;
}

impl<R: Real> Blend<R> for R {
    #[inline(always)]
    fn blend(self, other: Self, t: R) -> Self {
        self + t * (other - self)
    }
}

impl<R: Real> Blend<R> for [R; 4] {
    #[inline(always)]
    fn blend(self, other: Self, t: R) -> Self {
        std::array::from_fn(|c| self[c] + t * (other[c] - self[c]))
    }
}

/// The eight values around a point, lower before upper, x fastest.
#[inline(always)]
pub fn corners<R: Real, V: Copy>(data: &[V], [_, sy, sz]: [usize; 3], [x, y, z]: &[Stencil<R>; 3]) -> [V; 8] {
    let at = x.near + sy * y.near + sz * z.near;
    let block = &data[at..at + sz + sy + 2];
    [block[0], block[1], block[sy], block[sy + 1], block[sz], block[sz + 1], block[sz + sy], block[sz + sy + 1]]
}

/// Trilinear interpolation of eight corner values.
#[inline(always)]
pub fn mix<R: Real, V: Blend<R>>(v: [V; 8], [x, y, z]: &[Stencil<R>; 3]) -> V {
    let near = v[0].blend(v[1], x.fraction).blend(v[2].blend(v[3], x.fraction), y.fraction);
    let far = v[4].blend(v[5], x.fraction).blend(v[6].blend(v[7], x.fraction), y.fraction);
    near.blend(far, z.fraction)
}

/// Trilinear interpolation of `data`, with its ghosts, at the point of the stencils.
#[inline(always)]
pub fn trilinear<R: Real, V: Blend<R>>(data: &[V], strides: [usize; 3], stencils: &[Stencil<R>; 3]) -> V {
    mix(corners(data, strides, stencils), stencils)
}
