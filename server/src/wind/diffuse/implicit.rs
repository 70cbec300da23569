//! Backward Euler by a direct solve.

use crate::wind::separable::{Basis, Edge, Separable};
use crate::wind::{Boundary, Field, Grid, Place, Real};

/// Solves `(1 − ν·dt·∇²)·u = start` exactly, one field at a time, by transforms along the axes of the box.
///
/// Unconditionally stable; first order in dt, second in h. Continued in a straight line to twice the step it is the Crank–Nicolson scheme, second order in
/// both. On faces of outflow the velocity through them is held for the step.
pub struct Implicit {
    /// One per place: the three faces, and the centre.
    solvers: [Option<Separable>; 4],
    values: Vec<f64>,
}

impl Implicit {
    /// Plans the transforms for fields of all places on `grid`.
    pub fn new<R: Real>(grid: &Grid<R>) -> Self {
        let places = [Place::Face(0), Place::Face(1), Place::Face(2), Place::Centre];
        let solvers = places.map(|place| {
            let unknowns = unknowns(grid, place);
            let bases = [0, 1, 2].map(|axis| basis(grid, place, axis));
            (unknowns.iter().product::<usize>() > 0).then(|| Separable::new(unknowns, grid.spacing_m.map(R::wide), bases))
        });
        Self { solvers, values: vec![0.0; grid.len()] }
    }

    /// Takes a step of `dt_secs` (s), from `field`, whose ghosts are filled, in place; the ghosts are left to be filled again.
    pub fn step<R: Real>(&mut self, grid: &Grid<R>, diffusivity_m2_per_s: f64, dt_secs: f64, field: &mut Field<R>) {
        let place = field.place;
        let slot = match place {
            Place::Face(axis) => axis,
            Place::Centre => 3,
        };
        let Some(solver) = &mut self.solvers[slot] else { return };
        let shift = (diffusivity_m2_per_s * dt_secs).recip();
        let [nx, ny, nz] = unknowns(grid, place);
        let first = [0, 1, 2].map(|axis| first_unknown(grid, place, axis));
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
        // What faces with a given velocity add: the ghost is 2w − u, of which −u is in the transform.
        let mut add =
            |index: [usize; 3], axis: usize, outside: f64| values[index[0] + nx * (index[1] + ny * index[2])] += outside * per_m2[axis];
        for (axis, &step) in strides.iter().enumerate() {
            let Basis::Centres(edges) = basis(grid, place, axis) else {
                if place == Place::Face(axis) && !grid.wraps(axis) {
                    for_each_of_ends([nx, ny, nz], axis, |index, side| {
                        let node = at(index[1], index[2]) + index[0];
                        let beyond = if side == 0 { node - step } else { node + step };
                        add(index, axis, field.data[beyond].wide());
                    });
                }
                continue;
            };
            for_each_of_ends([nx, ny, nz], axis, |index, side| {
                if edges[side] == Edge::Dirichlet {
                    let inner = at(index[1], index[2]) + index[0];
                    let ghost = if side == 0 { inner - step } else { inner + step };
                    add(index, axis, (field.data[ghost] + field.data[inner]).wide());
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

fn first_unknown<R: Real>(grid: &Grid<R>, place: Place, axis: usize) -> usize {
    usize::from(place == Place::Face(axis) && !grid.wraps(axis))
}

fn unknowns<R: Real>(grid: &Grid<R>, place: Place) -> [usize; 3] {
    [0, 1, 2].map(|axis| grid.cells[axis] - first_unknown(grid, place, axis))
}

fn basis<R: Real>(grid: &Grid<R>, place: Place, axis: usize) -> Basis {
    if grid.wraps(axis) {
        return Basis::Wrap;
    }
    if place == Place::Face(axis) {
        return Basis::Nodes;
    }
    let is_velocity = place != Place::Centre;
    Basis::Centres(grid.boundary[axis].map(|face: Boundary| if is_velocity && face.holds_air() { Edge::Dirichlet } else { Edge::Neumann }))
}
