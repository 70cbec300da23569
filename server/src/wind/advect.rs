//! Carrying a field along the paths of the air: the semi-Lagrangian family.

use super::boundary::Beyond;
use super::parallel::{for_each_chunk, for_each_chunk_pair};
use super::sample::{self, Ends, Stencil};
use super::trace::Paths;
use super::{Advection, Field, GHOST, Grid, Place, Real};

/// What advection needs beside its input and output, kept from step to step.
#[derive(Clone, Debug)]
pub struct Scratch<R> {
    carried: Field<R>,
    bounds: Vec<[R; 2]>,
}

impl<R: Real> Scratch<R> {
    /// Room for one field of `grid` of `len` values in memory; 0 where nothing will be carried.
    pub fn new(grid: &Grid<R>, len: usize) -> Self {
        let carried = Field { place: Place::Centre, shape: grid.cells, data: vec![R::zero(); len] };
        Self { carried, bounds: vec![[R::zero(); 2]; len] }
    }

    /// Numbers held.
    pub(super) fn values(&self) -> usize {
        self.carried.data.len() + 2 * self.bounds.len()
    }
}

/// Advances `field`, its ghosts filled, by one step along `paths`, into the values of `target` that the flow decides. `close` fills in the rest of a field, with
/// what it is told on faces of inflow.
/// `scheme` is one of the semi-Lagrangian family.
///
/// Stable at any step: semi-Lagrangian values are means of old ones, and so are those of MacCormack and BFECC where the correction would leave the range of the
/// eight values about the departure point (Selle et al. 2008, §3.3). Setting such values to the bound itself, the other limiter in use, picks extremes in place of
/// means: in turbulent air at Courant numbers from 3 on, kinetic energy then grows without end.
pub fn advect<R: Real>(
    scheme: Advection,
    grid: &Grid<R>,
    paths: &Paths<R>,
    field: &Field<R>,
    target: &mut Field<R>,
    scratch: &mut Scratch<R>,
    close: impl Fn(&mut Field<R>, Beyond),
) {
    let Scratch { carried, bounds } = scratch;
    carried.place = field.place;
    carried.shape = field.shape;
    match scheme {
        Advection::MacCormack => {
            first_guess(grid, &paths.back, field, carried, bounds);
            close(carried, Beyond::Extended);
            let half = R::of(0.5);
            pull(grid, &paths.ahead, carried, target, |at, returned, _| {
                let guess = carried.data[at];
                within(guess + half * (field.data[at] - returned), bounds[at], guess)
            });
        }
        Advection::Bfecc => {
            first_guess(grid, &paths.back, field, carried, bounds);
            close(carried, Beyond::Extended);
            let half = R::of(0.5);
            // Corrected, it still is the field of the beginning, with what blew in then.
            target.data.copy_from_slice(&field.data);
            pull(grid, &paths.ahead, carried, target, |at, returned, _| field.data[at] + half * (field.data[at] - returned));
            close(target, Beyond::Kept);
            std::mem::swap(&mut carried.data, &mut target.data);
            pull(grid, &paths.back, carried, target, |at, value, guess| within(value, bounds[at], guess));
        }
        Advection::SemiLagrangian | Advection::Conservative => pull(grid, &paths.back, field, target, |_, value, _| value),
    }
}

/// Sets each value of `target` to `f` of its index in memory, of what `source` holds where the air at it is displaced to, and of what it was.
fn pull<R: Real>(
    grid: &Grid<R>,
    displacement: &[[R; 4]],
    source: &Field<R>,
    target: &mut Field<R>,
    f: impl Fn(usize, R, R) -> R + Sync + Send,
) {
    let plane_len = grid.strides()[2];
    for_each_chunk(&mut target.data, plane_len, |plane, out| {
        for_each_departure(grid, source, displacement, plane, |at, stencils| {
            let value = &mut out[at - plane * plane_len];
            *value = f(at, sample::trilinear(&source.data, grid.strides(), &stencils), *value);
        });
    });
}

/// The semi-Lagrangian values, and the range of the eight each is made of.
fn first_guess<R: Real>(grid: &Grid<R>, displacement: &[[R; 4]], source: &Field<R>, target: &mut Field<R>, bounds: &mut [[R; 2]]) {
    let plane_len = grid.strides()[2];
    for_each_chunk_pair(&mut target.data, plane_len, bounds, plane_len, |plane, out, bounds| {
        for_each_departure(grid, source, displacement, plane, |at, stencils| {
            let corners = sample::corners(&source.data, grid.strides(), &stencils);
            out[at - plane * plane_len] = sample::mix(corners, &stencils);
            bounds[at - plane * plane_len] = [extreme(corners, min), extreme(corners, max)];
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

/// `x`, or where it is beyond its bounds `otherwise`; NaN stays NaN.
#[inline(always)]
fn within<R: Real>(x: R, [low, high]: [R; 2], otherwise: R) -> R {
    if x < low || x > high { otherwise } else { x }
}

/// Calls `f(index in memory, stencils)` for each value of `field` in a plane of memory that the flow decides, with the stencils of the point its air is
/// displaced to.
#[inline(always)]
fn for_each_departure<R: Real>(
    grid: &Grid<R>,
    field: &Field<R>,
    displacement: &[[R; 4]],
    plane: usize,
    mut f: impl FnMut(usize, [Stencil<R>; 3]),
) {
    let place = field.place;
    if plane < GHOST || !grid.free(place, 2).contains(&(plane - GHOST)) {
        return;
    }
    let k = plane - GHOST;
    let back = match place {
        Place::Centre => 0,
        Place::Face(axis) => grid.strides()[axis],
    };
    let ends: [Ends<R>; 3] = std::array::from_fn(|axis| Ends::of(grid, place, axis));
    let half = R::of(0.5);
    for j in grid.free(place, 1) {
        for i in grid.free(place, 0) {
            let at = grid.at([i, j, k]);
            let (a, b) = (displacement[at], displacement[at - back]);
            let shift = |axis: usize| half * (a[axis] + b[axis]);
            let stencils = [Stencil::new(i, shift(0), ends[0]), Stencil::new(j, shift(1), ends[1]), Stencil::new(k, shift(2), ends[2])];
            f(at, stencils);
        }
    }
}
