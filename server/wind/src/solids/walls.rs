//! Walls immersed in the grid: faces inside them, and faces whose neighbours are.
//!
//! A face whose centre is inside a wall has the velocity of the wall. A face outside, with a neighbour of the same component inside, keeps its momentum equation;
//! only the viscous stress towards that neighbour acts over the distance θh to the surface instead of h (Gibou, Fedkiw, Cheng & Kang, J. Comput. Phys. 176
//! (2002)), which adds `ν/h²·(u_surface/θ − u_inside − (1/θ − 1)·u)`. This is a Brinkman penalty `−λ(u − v)` (Angot, Bruneau & Fabrie, Numer. Math. 81 (1999)) with
//! λ = ∞ inside and λ = ν/h²·(1/θ − 1) next to the surface, so that a steady flow does not depend on the time step.

use super::Body;
use crate::boundary::Boundary;
use crate::field::Velocity;
use crate::grid::{Grid, Location};
use crate::real::Real;
use std::ops::Range;

/// Smallest distance to a surface, in cells, that counts: nearer faces are as far as this.
const NEAREST: f64 = 1e-3;

/// A face that a wall acts on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WallFace<R> {
    /// Index of the face in memory.
    pub(crate) at: usize,
    /// Numbers of the cells before and behind it, x fastest.
    pub(crate) cells: [usize; 2],
    /// Rate λ (1/s) at which the velocity tends to that of the wall; infinite inside it.
    pub(crate) rate_per_s: R,
    /// Inside, the velocity of the wall (m/s); outside, λ times the velocity to which the face tends (m/s²).
    pub(crate) target: R,
    /// Velocity (m/s) that the wall gave the face in the newest step, without pressure.
    pub(crate) gain: R,
    /// Fraction `1 − 1/(1 + λ·dt)` of the pressure gradient that the wall bears in the newest step.
    pub(crate) held: f64,
}

/// Walls in a grid, with the force on them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Walls<R> {
    /// The faces across x, y and z: those of fixed walls in memory order, then those of moving ones.
    pub(crate) faces: [Vec<WallFace<R>>; 3],
    /// Number of faces of fixed walls.
    fixed: [usize; 3],
    /// Momentum over density (m⁴/s) that the air has lost to the walls in the newest step.
    pub(crate) impulse_m4_per_s: [f64; 3],
}

impl<R: Real> Walls<R> {
    /// Sets the fixed walls, and removes moving ones; see [`Solver::set_walls`](crate::Solver::set_walls).
    pub(super) fn set_fixed(
        &mut self,
        grid: &Grid<R>,
        viscosity_m2_per_s: f64,
        distance_m: impl Fn([f64; 3]) -> f64,
        velocity_m_per_s: impl Fn([f64; 3]) -> [f64; 3],
    ) {
        let surface = Surface { grid, viscosity_m2_per_s, distance_m, velocity_m_per_s };
        for (axis, faces) in self.faces.iter_mut().enumerate() {
            faces.clear();
            let [xs, ys, zs] = [0, 1, 2].map(|along| grid.inner(Location::Face(axis), along));
            for k in zs {
                for j in ys.clone() {
                    faces.extend(xs.clone().filter_map(|i| surface.face(axis, [i, j, k])));
                }
            }
            self.fixed[axis] = faces.len();
        }
    }

    /// Sets the moving walls. A face that a fixed wall acts on remains that wall's; of several bodies, one that contains the face
    /// comes first, and of those the one with the lower velocity.
    pub(super) fn set_moving<'a>(&mut self, grid: &Grid<R>, viscosity_m2_per_s: f64, bodies: impl Iterator<Item = &'a Body>) {
        self.faces.iter_mut().zip(self.fixed).for_each(|(faces, fixed)| faces.truncate(fixed));
        for body in bodies {
            let surface = Surface {
                grid,
                viscosity_m2_per_s,
                distance_m: |position_m| body.distance_m(nearest_image(grid, position_m, body.centre_m)),
                velocity_m_per_s: |_| body.velocity_m_per_s,
            };
            for (axis, faces) in self.faces.iter_mut().enumerate() {
                let [xs, ys, zs] = [0, 1, 2].map(|along| around(grid, Location::Face(axis), along, body));
                for k in zs {
                    for j in ys.clone() {
                        faces.extend(xs.clone().filter_map(|i| surface.face(axis, wrapped(grid, [i, j, k]))));
                    }
                }
            }
        }
        for (faces, fixed) in self.faces.iter_mut().zip(self.fixed) {
            keep_first(faces, fixed);
        }
    }

    /// Whether no wall acts on any face.
    pub(crate) fn is_empty(&self) -> bool {
        self.faces.iter().all(Vec::is_empty)
    }

    /// Number of faces inside the walls and next to them.
    pub(crate) fn len(&self) -> usize {
        self.faces.iter().map(Vec::len).sum()
    }

    /// Memory of the faces (bytes).
    pub(super) fn memory_bytes(&self) -> usize {
        self.faces.iter().map(|faces| faces.capacity() * size_of::<WallFace<R>>()).sum()
    }

    /// Gives back to the faces of `velocity` the share of a pressure gradient that the walls bear, which has acted on them for `acted_secs` (s) of a step of `dt_secs`. Stages
    /// of a step would else carry air through the walls.
    pub(crate) fn bear(&self, dt_secs: f64, acted_secs: f64, pressure_gradient: &Velocity<R>, velocity: &mut Velocity<R>) {
        for axis in 0..3 {
            let (gradient, field) = (&pressure_gradient.0[axis].data, &mut velocity.0[axis].data);
            for face in &self.faces[axis] {
                field[face.at] = field[face.at] + R::of(acted_secs * face.held_after(dt_secs)) * gradient[face.at];
            }
        }
    }

    /// Gives the faces of `velocity` what the walls demand after `dt_secs` (s), by a backward Euler step. [`Walls::bear`] has given back the share of the pressure gradient, which
    /// counts as the walls' force.
    pub(crate) fn hold(&mut self, dt_secs: f64, pressure_gradient: &Velocity<R>, velocity: &mut Velocity<R>) {
        let dt = R::of(dt_secs);
        for (axis, faces) in self.faces.iter_mut().enumerate() {
            let (gradient, field) = (&pressure_gradient.0[axis].data, &mut velocity.0[axis].data);
            for face in faces {
                face.held = face.held_after(dt_secs);
                let before = field[face.at] - R::of(dt_secs * face.held) * gradient[face.at];
                let after =
                    if face.rate_per_s.is_finite() { (before + dt * face.target) / (R::one() + dt * face.rate_per_s) } else { face.target };
                face.gain = after - before;
                field[face.at] = after;
            }
        }
    }
}

impl<R: Real> WallFace<R> {
    fn new(grid: &Grid<R>, axis: usize, index: [usize; 3], rate_per_s: R, target: R) -> Self {
        let [nx, ny, _] = grid.cells;
        let mut before = index;
        before[axis] = if index[axis] == 0 { grid.cells[axis] - 1 } else { index[axis] - 1 };
        let cells = [before, index].map(|[i, j, k]| i + nx * (j + ny * k));
        Self { at: grid.at(index), cells, rate_per_s, target, gain: R::zero(), held: 0.0 }
    }

    /// Fraction of the pressure gradient that the wall bears in a step of `dt_secs` (s).
    fn held_after(&self, dt_secs: f64) -> f64 {
        if self.rate_per_s.is_finite() { 1.0 - (R::one() + R::of(dt_secs) * self.rate_per_s).wide().recip() } else { 1.0 }
    }
}

/// A surface in a grid.
struct Surface<'a, R, D, V> {
    grid: &'a Grid<R>,
    viscosity_m2_per_s: f64,
    distance_m: D,
    velocity_m_per_s: V,
}

impl<R: Real, D: Fn([f64; 3]) -> f64, V: Fn([f64; 3]) -> [f64; 3]> Surface<'_, R, D, V> {
    /// The face across `axis` with this index, if the wall acts on it.
    fn face(&self, axis: usize, index: [usize; 3]) -> Option<WallFace<R>> {
        let grid = self.grid;
        let position_m = grid.position_m(Location::Face(axis), index).map(R::wide);
        let distance_m = (self.distance_m)(position_m);
        if distance_m <= 0.0 {
            let target = R::of((self.velocity_m_per_s)(position_m)[axis]);
            return Some(WallFace::new(grid, axis, index, R::infinity(), target));
        }
        if distance_m >= grid.spacing_m.map(R::wide).into_iter().fold(0.0, f64::max) {
            return None;
        }
        let [rate, drive] = self.stress(axis, position_m, distance_m).map(|sum| self.viscosity_m2_per_s * sum);
        (rate > 0.0).then(|| WallFace::new(grid, axis, index, R::of(rate), R::of(drive)))
    }

    /// Sums over the neighbours inside walls of `(1/θ − 1)/h²` (1/m²), and of `(u_surface/θ − u_inside)/h²`, of the face across `axis` at a position outside.
    fn stress(&self, axis: usize, position_m: [f64; 3], distance_m: f64) -> [f64; 2] {
        let grid = self.grid;
        let mut sums = [0.0; 2];
        for along in (0..3).filter(|&along| grid.cells[along] > 1) {
            let spacing_m = grid.spacing_m[along].wide();
            for step_m in [-spacing_m, spacing_m] {
                let moved = |by_m: f64| {
                    let mut position_m = position_m;
                    position_m[along] += by_m;
                    if grid.wraps(along) {
                        position_m[along] = position_m[along].rem_euclid(grid.extent_m(along).wide());
                    }
                    position_m
                };
                // Beyond a face of the box friction acts towards the face where that has a velocity, and not at all where it is free.
                let beyond = self.beyond(along, position_m[along] + step_m);
                if beyond.is_some_and(Boundary::fixes_tangential_velocity) {
                    continue;
                }
                let inside_m = (self.distance_m)(moved(step_m));
                if inside_m <= 0.0 {
                    let inside = if beyond.is_some() { 0.0 } else { 1.0 };
                    let theta = (distance_m / (distance_m - inside_m)).max(NEAREST);
                    let [surface, neighbour] = [theta * step_m, step_m].map(|by_m| (self.velocity_m_per_s)(moved(by_m))[axis]);
                    sums[0] += (theta.recip() - inside) / (spacing_m * spacing_m);
                    sums[1] += (surface / theta - inside * neighbour) / (spacing_m * spacing_m);
                }
            }
        }
        sums
    }
}

impl<R: Real, D, V> Surface<'_, R, D, V> {
    /// The face of the box between the air and a coordinate (m) beyond it.
    fn beyond(&self, along: usize, coordinate_m: f64) -> Option<Boundary> {
        let [low, high] = self.grid.boundary[along];
        match coordinate_m {
            _ if self.grid.wraps(along) => None,
            _ if coordinate_m < 0.0 => Some(low),
            _ if coordinate_m > self.grid.extent_m(along).wide() => Some(high),
            _ => None,
        }
    }
}

/// An index with those along periodic axes in the box; along others it is there already.
fn wrapped<R: Real>(grid: &Grid<R>, index: [i64; 3]) -> [usize; 3] {
    [0, 1, 2].map(|axis| (if grid.wraps(axis) { index[axis].rem_euclid(grid.cells[axis] as i64) } else { index[axis] }) as usize)
}

/// Offset (m) of a position from the nearest image of `centre_m`.
fn nearest_image<R: Real>(grid: &Grid<R>, position_m: [f64; 3], centre_m: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|axis| {
        let (offset_m, extent_m) = (position_m[axis] - centre_m[axis], grid.extent_m(axis).wide());
        if grid.wraps(axis) { (offset_m + 0.5 * extent_m).rem_euclid(extent_m) - 0.5 * extent_m } else { offset_m }
    })
}

/// Indices along an axis of the values in a body or less than a cell from it; on a periodic axis each index counts modulo the number of cells.
fn around<R: Real>(grid: &Grid<R>, location: Location, along: usize, body: &Body) -> Range<i64> {
    let spacing_m = grid.spacing_m[along].wide();
    let (centre_m, reach_m) = (body.centre_m[along], body.bounds_m()[along] + spacing_m);
    let index = |position_m: f64| position_m / spacing_m - grid.offset(location, along).wide();
    let range = index(centre_m - reach_m).ceil() as i64..index(centre_m + reach_m).floor() as i64 + 1;
    if grid.wraps(along) {
        let first = range.start;
        return first..range.end.min(first + grid.cells[along] as i64);
    }
    let inner = grid.inner(location, along);
    range.start.max(inner.start as i64)..range.end.min(inner.end as i64)
}

/// Removes from the faces of moving walls, `faces[fixed..]`, those of fixed walls and all but the first for each face.
fn keep_first<R: Real>(faces: &mut Vec<WallFace<R>>, fixed: usize) {
    let (own, moving) = faces.split_at_mut(fixed);
    // Inside walls first. A stable sort would allocate.
    let place = |face: &WallFace<R>| (face.at, face.rate_per_s.is_finite());
    moving.sort_unstable_by(|a, b| place(a).cmp(&place(b)).then(a.target.wide().total_cmp(&b.target.wide())));
    let mut kept = 0;
    for n in 0..moving.len() {
        let is_repeated = kept > 0 && moving[kept - 1].at == moving[n].at;
        if !is_repeated && own.binary_search_by_key(&moving[n].at, |face| face.at).is_err() {
            moving[kept] = moving[n];
            kept += 1;
        }
    }
    faces.truncate(fixed + kept);
}
