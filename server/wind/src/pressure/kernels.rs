//! Kernels over contiguous values. Each is also compiled for AVX2 and selected at run time; without fused multiply-add both versions give the same
//! bits.

use multiversion::multiversion;

use super::super::Real;

/// Number of independent partial sums, which break the dependency chain of the additions.
const LANES: usize = 8;

/// Six neighbours of a run of cells and the couplings to them; all slices have one length.
#[derive(Clone, Copy)]
pub(super) struct Around<'a, R> {
    /// Values of the lower neighbours along x, y and z.
    pub(super) below: [&'a [R]; 3],
    /// Values of the upper neighbours.
    pub(super) above: [&'a [R]; 3],
    /// Couplings to the lower neighbours.
    pub(super) lower: [&'a [R]; 3],
    /// Couplings to the upper neighbours.
    pub(super) upper: [&'a [R]; 3],
}

impl<'a, R: Real> Around<'a, R> {
    /// Reslices all to `len` values, so that the compiler omits bounds checks.
    #[inline(always)]
    fn of_len(self, len: usize) -> Self {
        let cut = |slices: [&'a [R]; 3]| slices.map(|slice| &slice[..len]);
        Self { below: cut(self.below), above: cut(self.above), lower: cut(self.lower), upper: cut(self.upper) }
    }

    /// Sum of coupling times value over the two neighbours of cell `i` along an axis.
    #[inline(always)]
    fn along(&self, axis: usize, i: usize) -> R {
        self.lower[axis][i] * self.below[axis][i] + self.upper[axis][i] * self.above[axis][i]
    }

    /// The same over all six neighbours.
    #[inline(always)]
    fn sum(&self, i: usize) -> R {
        self.along(0, i) + self.along(1, i) + self.along(2, i)
    }
}

/// `p = (b + Σ c p_neighbour) / d`: one half of a Gauss–Seidel sweep.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn relax<R: Real>(p: &mut [R], b: &[R], inverse: &[R], around: Around<R>) {
    let len = p.len();
    let (b, inverse, around) = (&b[..len], &inverse[..len], around.of_len(len));
    for i in 0..len {
        p[i] = (b[i] + around.sum(i)) * inverse[i];
    }
}

/// `p = keep p + gain (b + Σ c p_neighbour)`: the same, over-relaxed or damped.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn over_relax<R: Real>(p: &mut [R], b: &[R], [keep, gain]: [&[R]; 2], around: Around<R>) {
    let len = p.len();
    let (b, keep, gain, around) = (&b[..len], &keep[..len], &gain[..len], around.of_len(len));
    for i in 0..len {
        p[i] = keep[i] * p[i] + gain[i] * (b[i] + around.sum(i));
    }
}

/// The part of [`relax`] that does not depend on the lower neighbour along x.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn relax_but_for_lower_x<R: Real>(t: &mut [R], b: &[R], inverse: &[R], around: Around<R>) {
    let len = t.len();
    let (b, inverse, around) = (&b[..len], &inverse[..len], around.of_len(len));
    for i in 0..len {
        t[i] = (b[i] + around.upper[0][i] * around.above[0][i] + around.along(1, i) + around.along(2, i)) * inverse[i];
    }
}

/// `r = b − A p`, and 0 where no face is open, as in ghosts.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn residual<R: Real>(r: &mut [R], p: &[R], b: &[R], diagonal: &[R], around: Around<R>) {
    let len = r.len();
    let (p, b, diagonal, around) = (&p[..len], &b[..len], &diagonal[..len], around.of_len(len));
    for i in 0..len {
        let r_i = b[i] + around.sum(i) - diagonal[i] * p[i];
        r[i] = if diagonal[i] > R::zero() { r_i } else { R::zero() };
    }
}

/// `q = A p`, and 0 where no face is open, as in ghosts.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn apply<R: Real>(q: &mut [R], p: &[R], diagonal: &[R], around: Around<R>) {
    let len = q.len();
    let (p, diagonal, around) = (&p[..len], &diagonal[..len], around.of_len(len));
    for i in 0..len {
        let q_i = diagonal[i] * p[i] - around.sum(i);
        q[i] = if diagonal[i] > R::zero() { q_i } else { R::zero() };
    }
}

/// `y = a b`.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn multiply<R: Real>(y: &mut [R], a: &[R], b: &[R]) {
    let len = y.len();
    let (a, b) = (&a[..len], &b[..len]);
    for i in 0..len {
        y[i] = a[i] * b[i];
    }
}

/// `y = y + s x`.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn add_scaled(y: &mut [f64], x: &[f64], s: f64) {
    let x = &x[..y.len()];
    for i in 0..y.len() {
        y[i] += s * x[i];
    }
}

/// `y = x + s y`.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn scale_add(y: &mut [f64], x: &[f64], s: f64) {
    let x = &x[..y.len()];
    for i in 0..y.len() {
        y[i] = x[i] + s * y[i];
    }
}

/// Sum of a·b.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    sums.iter().sum::<f64>() + a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum::<f64>()
}

/// `y = s x` in single precision.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn narrow(y: &mut [f32], x: &[f64], s: f64) {
    let x = &x[..y.len()];
    for i in 0..y.len() {
        y[i] = (s * x[i]) as f32;
    }
}

/// `y = s x` from single precision.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn widen(y: &mut [f64], x: &[f32], s: f64) {
    let x = &x[..y.len()];
    for i in 0..y.len() {
        y[i] = s * f64::from(x[i]);
    }
}

/// `y = y + x`.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn add<R: Real>(y: &mut [R], x: &[R]) {
    let x = &x[..y.len()];
    for i in 0..y.len() {
        y[i] = y[i] + x[i];
    }
}

/// Moves the fraction `weight` of `x` out of `kept`, in place: `x = weight x`, `kept = kept − x`.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn take_fraction<R: Real>(kept: &mut [R], x: &mut [R], weight: &[R]) {
    let len = x.len();
    let (kept, weight) = (&mut kept[..len], &weight[..len]);
    for i in 0..len {
        x[i] = weight[i] * x[i];
        kept[i] = kept[i] - x[i];
    }
}

/// `y = y + weight (x − e)`.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn lean<R: Real>(y: &mut [R], weight: &[R], x: &[R], e: &[R]) {
    let len = y.len();
    let (weight, x, e) = (&weight[..len], &x[..len], &e[..len]);
    for i in 0..len {
        y[i] = y[i] + weight[i] * (x[i] - e[i]);
    }
}

/// Splits the alternating values of `natural` into two colours.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn deal<R: Real>(natural: &[R], red: &mut [R], black: &mut [R]) {
    for ((pair, red), black) in natural.as_chunks::<2>().0.iter().zip(red).zip(black) {
        [*red, *black] = *pair;
    }
}

/// Interleaves the values of two colours.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn interleave<R: Real>(natural: &mut [R], red: &[R], black: &[R]) {
    for ((pair, red), black) in natural.as_chunks_mut::<2>().0.iter_mut().zip(red).zip(black) {
        *pair = [*red, *black];
    }
}

/// `y = y + x`, with x alternating between `odd` (first, third, … value) and `even`.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn add_alternate<R: Real>(y: &mut [R], odd: &[R], even: &[R]) {
    let (pairs, last) = y.as_chunks_mut::<2>();
    let (odd, last_odd) = odd.split_at(pairs.len());
    for ((y, &odd), &even) in pairs.iter_mut().zip(odd).zip(even) {
        *y = [y[0] + odd, y[1] + even];
    }
    last.iter_mut().zip(last_odd).for_each(|(y, &odd)| *y = *y + odd);
}

/// `y = y + x`, with y alternating between `odd` and `even`.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn add_to_alternate<R: Real>(odd: &mut [R], even: &mut [R], x: &[R]) {
    let (pairs, last) = x.as_chunks::<2>();
    let (odd, last_odd) = odd.split_at_mut(pairs.len());
    for ((&[a, b], odd), even) in pairs.iter().zip(odd).zip(even) {
        *odd = *odd + a;
        *even = *even + b;
    }
    last_odd.iter_mut().zip(last).for_each(|(odd, &a)| *odd = *odd + a);
}

/// [`lean`] with y alternating between `odd` and `even`.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn lean_alternate<R: Real>(odd: &mut [R], even: &mut [R], [weight, x, e]: [&[R]; 3]) {
    let pairs = weight.len() / 2;
    for i in 0..pairs {
        odd[i] = odd[i] + weight[2 * i] * (x[2 * i] - e[2 * i]);
        even[i] = even[i] + weight[2 * i + 1] * (x[2 * i + 1] - e[2 * i + 1]);
    }
    if let Some(i) = (2 * pairs < weight.len()).then_some(2 * pairs) {
        odd[pairs] = odd[pairs] + weight[i] * (x[i] - e[i]);
    }
}
