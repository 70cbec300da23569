//! The matrix: couplings between cells that share an open face.

use super::super::Real;
use super::coloured::{Coloured, Layout, apart, at, set};
use super::kernels::{self, Around};

/// A symmetric positive semidefinite 7-point operator, `(A p)_i = d_i p_i − Σ c p_neighbour`, with couplings `c ≥ 0`; `d_i` is the sum of the
/// couplings to neighbours and to open edges of the box.
#[derive(Clone, Debug)]
pub(super) struct Operator<R> {
    pub(super) layout: Layout,
    /// Coupling of each cell to its lower neighbour along x, y and z; 0 through a closed face.
    pub(super) lower: [Coloured<R>; 3],
    /// d; 0 in ghosts, solid cells and cells without an open face.
    pub(super) diagonal: Coloured<R>,
    /// 1/d, or 0 where d is.
    pub(super) inverse: Coloured<R>,
}

impl Operator<f64> {
    /// Builds the operator from the couplings to lower neighbours (ghosts of periodic axes are filled in) and to the open edges of each axis.
    pub(super) fn new(layout: Layout, mut lower: [Coloured<f64>; 3], outlets: &[Coloured<f64>; 3]) -> Self {
        for field in &mut lower {
            layout.wrap(field);
        }
        let (mut diagonal, mut inverse) = (layout.zeros(), layout.zeros());
        for cell in layout.coordinates() {
            let l = layout.linear(cell);
            let faces = |axis: usize| at(&lower[axis], l) + at(&lower[axis], l + layout.stride[axis]) + at(&outlets[axis], l);
            let d = faces(0) + faces(1) + faces(2);
            set(&mut diagonal, l, d);
            set(&mut inverse, l, if d > 0.0 { 1.0 / d } else { 0.0 });
        }
        Self { layout, lower, diagonal, inverse }
    }

    /// The same in another precision.
    pub(super) fn cast<R: Real>(&self) -> Operator<R> {
        let cast = |field: &Coloured<f64>| [0, 1].map(|colour| field[colour].iter().map(|&v| R::of(v)).collect());
        let lower = [0, 1, 2].map(|axis| cast(&self.lower[axis]));
        Operator { layout: self.layout, lower, diagonal: cast(&self.diagonal), inverse: cast(&self.inverse) }
    }
}

impl<R: Real> Operator<R> {
    /// Neighbours of `len` cells of `colour` from `start` on; `other` holds the values of the other colour.
    #[inline(always)]
    pub(super) fn around<'a>(&'a self, colour: usize, start: usize, len: usize, other: &'a [R]) -> Around<'a, R> {
        let steps = [0, 1, 2].map(|axis| self.layout.steps(colour, axis));
        let below = steps.map(|[back, _]| &other[start - back..][..len]);
        let above = steps.map(|[_, on]| &other[start + on..][..len]);
        let lower = [0, 1, 2].map(|axis| &self.lower[axis][colour][start..][..len]);
        let upper = [0, 1, 2].map(|axis| &self.lower[axis][1 - colour][start + steps[axis][1]..][..len]);
        Around { below, above, lower, upper }
    }

    /// Solves the equations of the cells of `colour` for their own values, then refreshes their ghosts.
    pub(super) fn relax(&self, colour: usize, p: &mut Coloured<R>, b: &Coloured<R>) {
        let (own, other) = apart(p, colour);
        self.layout.for_each_plane(colour, own, |start, p| {
            let around = self.around(colour, start, p.len(), other);
            kernels::relax(p, &b[colour][start..], &self.inverse[colour][start..], around);
        });
        self.layout.wrap_after(colour, p);
    }

    /// [`relax`](Self::relax) where the other colour is 0.
    pub(super) fn relax_from_zero(&self, colour: usize, p: &mut Coloured<R>, b: &Coloured<R>) {
        self.layout.for_each_plane(colour, &mut p[colour], |start, p| {
            kernels::multiply(p, &b[colour][start..], &self.inverse[colour][start..]);
        });
        self.layout.wrap_after(colour, p);
    }

    /// `r = b − A p` in the cells of `colour`.
    pub(super) fn residual(&self, colour: usize, p: &Coloured<R>, b: &Coloured<R>, r: &mut Coloured<R>) {
        self.layout.for_each_plane(colour, &mut r[colour], |start, r| {
            let around = self.around(colour, start, r.len(), &p[1 - colour]);
            kernels::residual(r, &p[colour][start..], &b[colour][start..], &self.diagonal[colour][start..], around);
        });
    }
}

impl Operator<f64> {
    /// `r = b − A p`; returns `Σ r²`. `partial` holds a value for each chunk of the layout.
    pub(super) fn residual_sum(&self, p: &Coloured<f64>, b: &Coloured<f64>, r: &mut Coloured<f64>, partial: &mut [f64]) -> f64 {
        let mut sum = 0.0;
        for colour in 0..2 {
            sum += self.layout.sum_planes(colour, &mut r[colour], partial, |start, r| {
                let around = self.around(colour, start, r.len(), &p[1 - colour]);
                kernels::residual(r, &p[colour][start..], &b[colour][start..], &self.diagonal[colour][start..], around);
                kernels::dot(r, r)
            });
        }
        sum
    }

    /// `q = A p`; returns `p·q`.
    pub(super) fn apply_sum(&self, p: &Coloured<f64>, q: &mut Coloured<f64>, partial: &mut [f64]) -> f64 {
        let mut sum = 0.0;
        for colour in 0..2 {
            sum += self.layout.sum_planes(colour, &mut q[colour], partial, |start, q| {
                let p_own = &p[colour][start..][..q.len()];
                kernels::apply(q, p_own, &self.diagonal[colour][start..], self.around(colour, start, q.len(), &p[1 - colour]));
                kernels::dot(p_own, q)
            });
        }
        sum
    }
}
