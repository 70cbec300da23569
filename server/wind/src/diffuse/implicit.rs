//! Backward Euler by a direct solve.

use crate::boundary::friction;
use crate::separable::{Basis, Edge, Separable};
use crate::{Boundary, Field, Grid, Location, Real};

/// Solves `(1 − ν·dt·∇²)·u = start` exactly, one field at a time, by transforms along the axes of the box.
///
/// Unconditionally stable; first order in dt, second in h. Extrapolated linearly to twice the step it is the Crank–Nicolson scheme, second order in
/// both. On outflow faces the gradient of the velocity is zero; next to walls the equation is that of [`explicit`](super::explicit).
pub struct Implicit {
    /// One per location: the three faces, and the centre.
    solvers: [Option<Separable>; 4],
    values: Vec<f64>,
}

impl Implicit {
    /// Plans the transforms for fields of all locations on `grid`.
    pub fn new<R: Real>(grid: &Grid<R>) -> Self {
        let locations = [Location::Face(0), Location::Face(1), Location::Face(2), Location::Centre];
        let count = |location| unknowns(grid, location).iter().product::<usize>();
        let solvers = locations.map(|location| {
            let bases = [0, 1, 2].map(|axis| basis(grid, location, axis));
            (count(location) > 0).then(|| Separable::new(unknowns(grid, location), grid.spacing_m.map(R::wide), bases))
        });
        let most = locations.into_iter().map(count).max().unwrap_or(0);
        Self { solvers, values: vec![0.0; most] }
    }

    /// Takes a step of `dt_secs` (s) in place, from `field` with its ghosts filled; afterwards the ghosts must be filled again.
    pub fn step<R: Real>(&mut self, grid: &Grid<R>, diffusivity_m2_per_s: f64, dt_secs: f64, field: &mut Field<R>) {
        let location = field.location;
        let slot = match location {
            Location::Face(axis) => axis,
            Location::Centre => 3,
        };
        let Some(solver) = &mut self.solvers[slot] else { return };
        let shift = (diffusivity_m2_per_s * dt_secs).recip();
        let [nx, ny, nz] = unknowns(grid, location);
        let first = [0, 1, 2].map(|axis| grid.free(location, axis).start);
        let strides = grid.strides();
        let per_m2 = grid.spacing_m.map(|h| (h.wide() * h.wide()).recip());
        let values = &mut self.values[..nx * ny * nz];
        let at = |j: usize, k: usize| grid.at([first[0], first[1] + j, first[2] + k]);
        for (n, row) in values.chunks_mut(nx).enumerate() {
            let start = at(n % ny, n / ny);
            for (value, &u) in row.iter_mut().zip(&field.data[start..]) {
                *value = shift * u.wide();
            }
        }
        // Contribution of faces with a given velocity w: a node there has it; beyond centres the mirrored ghost is 2w − u, of which w alone is not part of the transform.
        let mut add =
            |index: [usize; 3], axis: usize, outside: f64| values[index[0] + nx * (index[1] + ny * index[2])] += outside * per_m2[axis];
        for (axis, &step) in strides.iter().enumerate() {
            let (is_given, on_faces) = match basis(grid, location, axis) {
                Basis::Nodes(edges) => (edges.map(|edge| edge == Edge::Dirichlet), true),
                Basis::Walls(walls) => (walls, false),
                Basis::Wrap | Basis::Centres(_) => continue,
            };
            let factor = if grid.cells[axis] > 1 { friction::FACTOR } else { 1.0 };
            for_each_of_ends([nx, ny, nz], axis, |index, side| {
                if is_given[side] {
                    let inner = at(index[1], index[2]) + index[0];
                    let beyond = field.data[if side == 0 { inner - step } else { inner + step }];
                    // A single node on a Neumann edge has the given value on both sides.
                    let times = if !is_given[1 - side] && [nx, ny, nz][axis] == 1 { 2.0 } else { 1.0 };
                    add(index, axis, if on_faces { times * beyond.wide() } else { factor * (beyond + field.data[inner]).wide() });
                }
            });
        }
        solver.solve(shift, values);
        for (n, row) in values.chunks(nx).enumerate() {
            let start = at(n % ny, n / ny);
            for (u, &value) in field.data[start..].iter_mut().zip(row) {
                *u = R::of(value);
            }
        }
    }
}

/// Calls `f(index, side)` for the unknowns at the low (0) and high (1) end of `axis`.
fn for_each_of_ends(unknowns: [usize; 3], axis: usize, mut f: impl FnMut([usize; 3], usize)) {
    let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
    for (side, end) in [0, unknowns[axis] - 1].into_iter().enumerate() {
        for m in 0..unknowns[a] {
            for n in 0..unknowns[b] {
                let mut index = [0; 3];
                (index[axis], index[a], index[b]) = (end, m, n);
                f(index, side);
            }
        }
    }
}

fn unknowns<R: Real>(grid: &Grid<R>, location: Location) -> [usize; 3] {
    [0, 1, 2].map(|axis| grid.free(location, axis).len())
}

fn basis<R: Real>(grid: &Grid<R>, location: Location, axis: usize) -> Basis {
    if grid.wraps(axis) {
        return Basis::Wrap;
    }
    if location == Location::Face(axis) {
        return Basis::Nodes(grid.boundary[axis].map(|face| if face.fixes_pressure() { Edge::Neumann } else { Edge::Dirichlet }));
    }
    let is_velocity = location != Location::Centre;
    Basis::Walls(grid.boundary[axis].map(|face: Boundary| is_velocity && face.fixes_tangential_velocity()))
}
