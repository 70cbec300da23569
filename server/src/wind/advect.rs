//! Carrying a field along with the air.

use super::parallel::{for_each_chunk, for_each_chunk_pair};
use super::sample::{self, Stencil};
use super::trace::Paths;
use super::{Advection, Field, Grid, Place, Real};

/// What advection needs beside its input and output, kept from step to step.
#[derive(Clone, Debug)]
pub struct Scratch<R> {
    carried: Vec<R>,
    bounds: Vec<[R; 2]>,
}

impl<R: Real> Scratch<R> {
    /// Room for the largest field of `grid`.
    pub fn new(grid: &Grid<R>) -> Self {
        let len = (0..3).map(|axis| grid.shape(Place::Face(axis)).iter().product()).max().unwrap_or(0);
        Self { carried: vec![R::zero(); len], bounds: vec![[R::zero(); 2]; len] }
    }
}

/// Advances `field` by one step along `paths`, into `target`. Faces on walls, which air does not leave, become 0.
///
/// Stable at any step: semi-Lagrangian values are means of old ones, and MacCormack's, whose unbounded amplification is `|G| ≤ 1 − (1 − |Â|)²/2` for a
/// symbol `Â` of the linear step, are moreover kept within the eight values about the departure point.
pub fn advect<R: Real>(
    scheme: Advection,
    grid: &Grid<R>,
    paths: &Paths<R>,
    field: &Field<R>,
    target: &mut Field<R>,
    scratch: &mut Scratch<R>,
) {
    match scheme {
        Advection::SemiLagrangian => semi_lagrangian(grid, &paths.back, field, target),
        Advection::MacCormack => mac_cormack(grid, paths, field, target, scratch),
    }
}

fn semi_lagrangian<R: Real>(grid: &Grid<R>, back: &[[R; 4]], field: &Field<R>, target: &mut Field<R>) {
    for_each_chunk(&mut target.data, field.plane_len(), |k, plane| {
        plane.fill(R::zero());
        for_each_departure(grid, field, back, k, |at, stencils| {
            plane[at] = sample::trilinear(&field.data, field.shape, &stencils);
        });
    });
}

fn mac_cormack<R: Real>(grid: &Grid<R>, paths: &Paths<R>, field: &Field<R>, target: &mut Field<R>, scratch: &mut Scratch<R>) {
    let plane_len = field.plane_len();
    let carried = &mut scratch.carried[..field.data.len()];
    let bounds = &mut scratch.bounds[..field.data.len()];
    for_each_chunk_pair(carried, plane_len, bounds, plane_len, |k, carried, bounds| {
        carried.fill(R::zero());
        for_each_departure(grid, field, &paths.back, k, |at, stencils| {
            let corners = sample::corners(&field.data, field.shape, &stencils);
            carried[at] = sample::mix(corners, &stencils);
            bounds[at] = [extreme(corners, min), extreme(corners, max)];
        });
    });
    let (carried, bounds, half) = (&*carried, &*bounds, R::of(0.5));
    for_each_chunk(&mut target.data, plane_len, |k, plane| {
        let (old, first, bounds) = (&field.data[k * plane_len..], &carried[k * plane_len..], &bounds[k * plane_len..]);
        plane.fill(R::zero());
        for_each_departure(grid, field, &paths.ahead, k, |at, stencils| {
            let returned = sample::trilinear(carried, field.shape, &stencils);
            plane[at] = within(first[at] + half * (old[at] - returned), bounds[at]);
        });
    });
}

// One comparison each; NaN, which the standard ones order too, is caught at the end of the step.
#[inline(always)]
fn min<R: Real>(a: R, b: R) -> R {
    if a < b { a } else { b }
}

#[inline(always)]
fn max<R: Real>(a: R, b: R) -> R {
    if a > b { a } else { b }
}

/// The value that `pick` prefers among eight, pair by pair.
#[inline(always)]
fn extreme<R: Real>(v: [R; 8], pick: impl Fn(R, R) -> R) -> R {
    let four: [R; 4] = std::array::from_fn(|c| pick(v[c], v[c + 4]));
    pick(pick(four[0], four[2]), pick(four[1], four[3]))
}

/// `x` or the bound it is beyond; NaN stays NaN.
#[inline(always)]
fn within<R: Real>(x: R, [low, high]: [R; 2]) -> R {
    if x < low {
        low
    } else if x > high {
        high
    } else {
        x
    }
}

/// Calls `f(index in the plane, stencils)` for each value of plane `k` of `field` that is not on a wall, with the stencils of the point its air is
/// displaced to.
#[inline(always)]
fn for_each_departure<R: Real>(
    grid: &Grid<R>,
    field: &Field<R>,
    displacement: &[[R; 4]],
    k: usize,
    mut f: impl FnMut(usize, [Stencil<R>; 3]),
) {
    let [nx, ny, nz] = field.shape;
    let wraps = [0, 1, 2].map(|axis| grid.wraps(axis));
    let half = R::of(0.5);
    let inner = |axis: usize| {
        let walls = usize::from(field.place == Place::Face(axis) && !wraps[axis]);
        walls..field.shape[axis] - walls
    };
    let below = |axis: usize, i: usize| if field.place == Place::Face(axis) { grid.below(axis, i) } else { i };
    if !inner(2).contains(&k) {
        return;
    }
    for j in inner(1) {
        let row = |j: usize, k: usize| &displacement[grid.cells[0] * (j + grid.cells[1] * k)..][..grid.cells[0]];
        let (here, there) = (row(j, k), row(below(1, j), below(2, k)));
        for i in inner(0) {
            let (a, b) = (here[i], there[below(0, i)]);
            let stencils = [
                Stencil::new(i, half * (a[0] + b[0]), nx, wraps[0]),
                Stencil::new(j, half * (a[1] + b[1]), ny, wraps[1]),
                Stencil::new(k, half * (a[2] + b[2]), nz, wraps[2]),
            ];
            f(i + nx * j, stencils);
        }
    }
}
