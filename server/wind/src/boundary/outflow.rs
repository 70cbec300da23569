//! Momentum through outflow faces.

use crate::field::{Field, Velocity};
use crate::grid::{Grid, Location};
use crate::real::Real;

/// Corrects the momentum that a stage of `gain_secs` (s) moved through outflow faces: `target` is a component after the stage, `air` the velocity before it, with
/// even ghosts beyond these faces.
///
/// A control volume with the velocity u loses `m·φ` through such a face by its mass flux m: φ = u where air leaves, and u/2 where it flows back in, the directional
/// do-nothing condition (Braack & Mucha, J. Comput. Math. 32 (2014)). The control volume of the normal velocity on the face itself is half a cell. Since mass
/// fluxes out of a control volume add up to 0, and central fluxes between control volumes conserve energy, transport then changes the kinetic energy at the rate
/// `Σ m·(u²/2 − u·φ)` over these faces: −|m|·u²/2 where air leaves, 0 where it flows back in.
pub(crate) fn correct_flux<R: Real>(grid: &Grid<R>, air: &Velocity<R>, gain_secs: f64, target: &mut Field<R>) {
    let Location::Face(component) = target.location else { return };
    for axis in 0..3 {
        let gain = R::of(gain_secs) / grid.spacing_m[axis];
        for side in (0..2).filter(|&side| grid.boundary[axis][side].fixes_pressure()) {
            let excess =
                |at| if component == axis { normal(grid, air, axis, side, at) } else { tangential(grid, air, component, axis, side, at) };
            for_each_next_to(grid, target.location, axis, side, |at| target.data[at] = target.data[at] - gain * excess(at));
        }
    }
}

/// Net flux out of the half cell at the face, per width of a cell; the one in place is 0, since even ghosts give both ends the same flux.
fn normal<R: Real>(grid: &Grid<R>, air: &Velocity<R>, axis: usize, side: usize, at: usize) -> R {
    let (step, u) = (grid.strides()[axis], &air.0[axis].data);
    let (here, inner) = (u[at], u[if side == 0 { at + step } else { at - step }]);
    let between = R::of(0.5) * (here + inner);
    let outwards = if side == 0 { -here } else { here };
    let carried = if outwards > R::zero() { here } else { R::of(0.5) * here };
    let net = R::of(2.0) * (here * carried - between * between);
    if side == 0 { -net } else { net }
}

/// Flux out of a cell of a tangential component, less the one in place, where the even ghost is carried.
fn tangential<R: Real>(grid: &Grid<R>, air: &Velocity<R>, component: usize, axis: usize, side: usize, at: usize) -> R {
    let (strides, through) = (grid.strides(), &air.0[axis].data);
    let face = if side == 0 { at } else { at + strides[axis] };
    let half = R::of(0.5);
    let mass = half * (through[face] + through[face - strides[component]]);
    let outwards = if side == 0 { -mass } else { mass };
    if outwards < R::zero() { -half * outwards * air.0[component].data[at] } else { R::zero() }
}

/// Calls `f` with the index in memory of each free value of a field at `location` on a face or, if it has none there, next to it.
fn for_each_next_to<R: Real>(grid: &Grid<R>, location: Location, axis: usize, side: usize, mut f: impl FnMut(usize)) {
    let mut ranges = [0, 1, 2].map(|along| grid.free(location, along));
    let Some(last) = ranges[axis].clone().last() else { return };
    ranges[axis] = if side == 0 { 0..1 } else { last..last + 1 };
    let [xs, ys, zs] = ranges;
    for k in zs {
        for j in ys.clone() {
            xs.clone().for_each(|i| f(grid.at([i, j, k])));
        }
    }
}
