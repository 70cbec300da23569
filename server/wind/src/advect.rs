//! Advection schemes, and the kernels of the semi-Lagrangian family. The fluxes of the conservative scheme are in [`transport`](super::transport).

use super::boundary::InflowGhosts;
use super::named::named_enum;
use super::parallel::{for_each_chunk, for_each_chunk_pair};
use super::sample::{self, Ends, Stencil};
use super::trajectory::Trajectories;
use super::{Field, GHOST, Grid, Location, Real};

named_enum! {
    /// Advection scheme of velocity or dust.
    Advection {
        /// The value at the departure point, interpolated linearly (Stam 1999; Zhang §2.3.3). Its numerical diffusivity is `|u|·h/2` at
        /// small Courant numbers.
        SemiLagrangian = "semi-lagrangian",
        /// A semi-Lagrangian step forward and back, corrected by half the round-trip error, with a limiter (Selle et al. 2008).
        MacCormack = "mac-cormack",
        /// Back and forth error compensation and correction (Dupont & Liu 2003): half the round-trip error is subtracted before the
        /// semi-Lagrangian step. With a limiter.
        Bfecc = "bfecc",
        /// Fluxes through cell faces by Runge–Kutta 3: central with upwind damping for velocity, limited for dust (see [`transport`](super::transport)).
        Conservative = "conservative",
    }
}

impl Advection {
    /// Formal order of accuracy for smooth fields, as spacing and time step are refined together.
    pub fn order(self) -> u32 {
        match self {
            Self::SemiLagrangian => 1,
            Self::MacCormack | Self::Bfecc | Self::Conservative => 2,
        }
    }

    /// Whether the scheme computes fluxes through cell faces. It then conserves the integral, and its step is limited by the Courant number; the others trace
    /// trajectories back and are stable at any step.
    pub fn uses_fluxes(self) -> bool {
        match self {
            Self::SemiLagrangian | Self::MacCormack | Self::Bfecc => false,
            Self::Conservative => true,
        }
    }

    /// Name in charts.
    pub fn label(self) -> &'static str {
        match self {
            Self::SemiLagrangian => "semi-Lagrangian",
            Self::MacCormack => "MacCormack",
            Self::Bfecc => "BFECC",
            Self::Conservative => "conservative",
        }
    }
}

/// Work arrays of [`advect`].
#[derive(Clone, Debug)]
pub struct AdvectionScratch<R> {
    carried: Field<R>,
    bounds: Vec<[R; 2]>,
}

impl<R: Real> AdvectionScratch<R> {
    /// Allocates work arrays for fields of `grid` with `len` values in memory; 0 if no scheme needs them.
    pub fn new(grid: &Grid<R>, len: usize) -> Self {
        let carried = Field { location: Location::Centre, shape: grid.cells, data: vec![R::zero(); len] };
        Self { carried, bounds: vec![[R::zero(); 2]; len] }
    }

    /// Number of values in the work arrays.
    pub(super) fn values(&self) -> usize {
        self.carried.data.len() + 2 * self.bounds.len()
    }
}

/// Advances `field`, whose ghosts are filled, by one step along `trajectories` into the interior values of `target`. `apply_boundaries` fills the ghosts of a
/// field.
///
/// Stable at any step: semi-Lagrangian values are means of old ones. MacCormack and BFECC fall back to them where the correction leaves the range of the eight
/// values around the departure point (Selle et al. 2008, §3.3). Clamping such values to the range, the other common limiter, selects extremes instead of means:
/// in turbulent air at Courant numbers from 3 on, kinetic energy then grows without bound.
///
/// # Panics
/// For a scheme that [uses fluxes](Advection::uses_fluxes).
pub fn advect<R: Real>(
    scheme: Advection,
    grid: &Grid<R>,
    trajectories: &Trajectories<R>,
    field: &Field<R>,
    target: &mut Field<R>,
    scratch: &mut AdvectionScratch<R>,
    apply_boundaries: impl Fn(&mut Field<R>, InflowGhosts),
) {
    let AdvectionScratch { carried, bounds } = scratch;
    carried.location = field.location;
    carried.shape = field.shape;
    match scheme {
        Advection::MacCormack => {
            first_guess(grid, &trajectories.backward, field, carried, bounds);
            apply_boundaries(carried, InflowGhosts::Extrapolated);
            let half = R::of(0.5);
            gather(grid, &trajectories.forward, carried, target, |at, returned, _| {
                let guess = carried.data[at];
                within(guess + half * (field.data[at] - returned), bounds[at], guess)
            });
        }
        Advection::Bfecc => {
            first_guess(grid, &trajectories.backward, field, carried, bounds);
            apply_boundaries(carried, InflowGhosts::Extrapolated);
            let half = R::of(0.5);
            // The corrected field is still the one at the start of the step, with its inflow values.
            target.data.copy_from_slice(&field.data);
            gather(grid, &trajectories.forward, carried, target, |at, returned, _| field.data[at] + half * (field.data[at] - returned));
            apply_boundaries(target, InflowGhosts::Unchanged);
            std::mem::swap(&mut carried.data, &mut target.data);
            gather(grid, &trajectories.backward, carried, target, |at, value, guess| within(value, bounds[at], guess));
        }
        Advection::SemiLagrangian => gather(grid, &trajectories.backward, field, target, |_, value, _| value),
        Advection::Conservative => unreachable!("fluxes are advanced by transport::Stage"),
    }
}

/// Sets each interior value of `target` to `f(index in memory, source interpolated at the displaced point, old value)`.
fn gather<R: Real>(
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

/// Semi-Lagrangian values, and the minimum and maximum of the eight values each is interpolated from.
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

// A single comparison each. Unlike `Float::min` they need not order NaN, which the diagnostics find at the end of the step.
#[inline(always)]
fn min<R: Real>(a: R, b: R) -> R {
    if a < b { a } else { b }
}

#[inline(always)]
fn max<R: Real>(a: R, b: R) -> R {
    if a > b { a } else { b }
}

/// Reduces eight values pairwise by `pick`.
#[inline(always)]
fn extreme<R: Real>(v: [R; 8], pick: impl Fn(R, R) -> R) -> R {
    let four: [R; 4] = std::array::from_fn(|c| pick(v[c], v[c + 4]));
    pick(pick(four[0], four[2]), pick(four[1], four[3]))
}

/// `x`, or `otherwise` if it is out of bounds; NaN stays NaN.
#[inline(always)]
fn within<R: Real>(x: R, [low, high]: [R; 2], otherwise: R) -> R {
    if x < low || x > high { otherwise } else { x }
}

/// Calls `f(index in memory, stencils)` for each interior value in one plane of `field`, with the interpolation stencils of its displaced point.
#[inline(always)]
fn for_each_departure<R: Real>(
    grid: &Grid<R>,
    field: &Field<R>,
    displacement: &[[R; 4]],
    plane: usize,
    mut f: impl FnMut(usize, [Stencil<R>; 3]),
) {
    let location = field.location;
    if plane < GHOST || !grid.free(location, 2).contains(&(plane - GHOST)) {
        return;
    }
    let k = plane - GHOST;
    let back = match location {
        Location::Centre => 0,
        Location::Face(axis) => grid.strides()[axis],
    };
    let ends: [Ends<R>; 3] = std::array::from_fn(|axis| Ends::of(grid, location, axis));
    let half = R::of(0.5);
    for j in grid.free(location, 1) {
        for i in grid.free(location, 0) {
            let at = grid.at([i, j, k]);
            let (a, b) = (displacement[at], displacement[at - back]);
            let shift = |axis: usize| half * (a[axis] + b[axis]);
            let stencils = [Stencil::new(i, shift(0), ends[0]), Stencil::new(j, shift(1), ends[1]), Stencil::new(k, shift(2), ends[2])];
            f(at, stencils);
        }
    }
}
