//! Trilinear interpolation.

use super::Real;

/// The two values about a point along one axis and the point's fraction of the way from the first to the second.
#[derive(Clone, Copy, Debug)]
pub struct Stencil<R> {
    /// Index of the first.
    pub near: usize,
    /// Index of the second, next to it on either side.
    pub far: usize,
    /// 0 at `near`, 1 at `far`.
    pub fraction: R,
}

impl<R: Real> Stencil<R> {
    /// The stencil of the point `shift` cells from index `i` on an axis of `n` values, however far: wrapped round, or held at the ends.
    #[inline(always)]
    pub fn new(i: usize, shift: R, n: usize, wraps: bool) -> Self {
        let distance = shift.abs();
        if distance < R::one() {
            let (before_first, after_last) = if wraps { (n - 1, 0) } else { (0, n - 1) };
            let below = if i == 0 { before_first } else { i - 1 };
            let above = if i + 1 == n { after_last } else { i + 1 };
            Self { near: i, far: if shift < R::zero() { below } else { above }, fraction: distance }
        } else {
            let (floor, fraction) = shift.split();
            let (near, far) = distant(i as isize + floor, n as isize, wraps);
            Self { near, far, fraction }
        }
    }
}

/// Where values `at` and `at + 1` of an axis of `n` are found.
#[cold]
fn distant(at: isize, n: isize, wraps: bool) -> (usize, usize) {
    let index = |at: isize| if wraps { at.rem_euclid(n) } else { at.clamp(0, n - 1) };
    (index(at) as usize, index(at + 1) as usize)
}

/// A value that can be mixed with another of its kind.
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

/// The eight values at the corners of the stencils, near before far, x fastest.
#[inline(always)]
pub fn corners<R: Real, V: Copy>(data: &[V], [nx, ny, _]: [usize; 3], [x, y, z]: &[Stencil<R>; 3]) -> [V; 8] {
    let plane = nx * ny;
    let [(south, north), (down, up)] = [(plane * z.near, plane * z.far), (nx * y.near, nx * y.far)];
    let [a, b, c, d] = [south + down, south + up, north + down, north + up];
    [
        data[a + x.near],
        data[a + x.far],
        data[b + x.near],
        data[b + x.far],
        data[c + x.near],
        data[c + x.far],
        data[d + x.near],
        data[d + x.far],
    ]
}

/// The trilinear mean of eight corner values.
#[inline(always)]
pub fn mix<R: Real, V: Blend<R>>(v: [V; 8], [x, y, z]: &[Stencil<R>; 3]) -> V {
    let near = v[0].blend(v[1], x.fraction).blend(v[2].blend(v[3], x.fraction), y.fraction);
    let far = v[4].blend(v[5], x.fraction).blend(v[6].blend(v[7], x.fraction), y.fraction);
    near.blend(far, z.fraction)
}

/// The trilinear value of `data`, an array of `shape` with x fastest, at the point of the stencils.
#[inline(always)]
pub fn trilinear<R: Real, V: Blend<R>>(data: &[V], shape: [usize; 3], stencils: &[Stencil<R>; 3]) -> V {
    mix(corners(data, shape, stencils), stencils)
}
