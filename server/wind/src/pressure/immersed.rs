//! Projection around immersed walls, with the transforms as preconditioner.
//!
//! With the rate λ at which a wall holds the air of a face, and β = 1/(1 + λ·dt), the velocity after the step is `β(u − ∇φ) + (1 − β)v`, so that the potential
//! solves `∇·β∇φ = ∇·(βu + (1 − β)v)`. Conjugate gradients preconditioned by the solver for β = 1 need few iterations, because all eigenvalues are in 0..1 and
//! only modes at the surface differ from 1; those of a compact body gather about ½. What is left after the last iteration is removed by an ordinary projection: the
//! result is divergence-free to rounding, and the tolerance limits the slip at the walls instead.
//!
//! No pressure acts on a cell whose faces are all inside walls or closed. If walls move air into or out of such cells, as a body that lifts off the floor does, the equation has no
//! solution, and only slip makes up for it: that air is set apart, and moved by an ordinary projection of its own, whose gradient isn't pressure that the next step keeps.

use super::{Convergence, PressureSolver, Projection, divergence, subtract_gradient};
use crate::field::Velocity;
use crate::grid::{Grid, Location};
use crate::real::Real;
use crate::separable::Separable;
use crate::solids::Walls;

/// Slip, relative to the rms speed of the air, at which the iteration ends: root mean square over the faces of the walls.
pub(crate) const SLIP: f64 = 1e-4;
/// Maximum number of iterations.
const MOST: u32 = 60;
/// Smallest eigenvalue that counts: the iteration ends at a direction whose image is smaller, of air that walls enclose in several cells.
const LEAST: f64 = 1e-6;

/// Work arrays of the iteration, one value per cell.
pub(crate) struct Iteration {
    potential: Vec<f64>,
    residual: Vec<f64>,
    direction: Vec<f64>,
    /// −∇² of the direction.
    image: Vec<f64>,
    /// Cells that walls enclose, with the residual that is set apart in them (1/s).
    enclosed: Vec<(usize, f64)>,
}

impl Iteration {
    /// Allocates for `cells` cells.
    pub(crate) fn new(cells: usize) -> Self {
        let zeros = || vec![0.0; cells];
        Self { potential: zeros(), residual: zeros(), direction: zeros(), image: zeros(), enclosed: Vec::new() }
    }

    /// Memory (bytes).
    pub(crate) fn memory_bytes(&self) -> usize {
        let values = [&self.potential, &self.residual, &self.direction, &self.image];
        values.map(|values| size_of_val(values.as_slice())).iter().sum::<usize>() + self.enclosed.capacity() * size_of::<(usize, f64)>()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Projection {
    /// [`Projection::project`] around walls that hold the velocity already, with its boundary values filled in, in air of rms speed `speed_m_per_s`. The residual is the
    /// slip relative to it.
    pub(crate) fn project_around<R: Real>(
        &mut self,
        grid: &Grid<R>,
        (walls, work): (&mut Walls<R>, &mut Iteration),
        speed_m_per_s: f64,
        velocity: &mut Velocity<R>,
        inflow: &[f64],
        pressure_gradient: Option<(&mut Velocity<R>, f64)>,
    ) -> Convergence {
        let Self { solver: PressureSolver::Direct(separable), divergence: ahead, .. } = self else {
            return self.project(grid, velocity, inflow, pressure_gradient);
        };
        let Iteration { potential, residual, direction, image, enclosed } = work;
        divergence(grid, velocity, -1.0, residual);
        residual.iter_mut().zip(inflow).for_each(|(residual, &inflow)| *residual += inflow);
        let elsewhere = set_apart(grid, walls, image, residual, enclosed);
        potential.fill(0.0);
        ahead.copy_from_slice(residual);
        separable.solve(0.0, ahead);
        let mut slip = dot(residual, ahead);
        let scale = walls.len() as f64 * speed_m_per_s * speed_m_per_s + slip;
        direction.copy_from_slice(ahead);
        image.copy_from_slice(residual);
        let mut sweeps = 0;
        while slip > (SLIP * SLIP * scale).max(f64::MIN_POSITIVE) && sweeps < MOST {
            // The image of the direction under −∇·β∇ differs from that under −∇² next to walls only.
            let energy = dot(direction, image);
            let free = energy - held_energy(grid, walls, direction);
            if free <= LEAST * energy {
                break;
            }
            let length = slip / free;
            potential.iter_mut().zip(&*direction).for_each(|(potential, direction)| *potential += length * direction);
            residual.iter_mut().zip(&*image).for_each(|(residual, image)| *residual -= length * image);
            give_back(grid, walls, direction, length, residual);
            ahead.copy_from_slice(residual);
            separable.solve(0.0, ahead);
            let next = dot(residual, ahead);
            let turn = next / slip;
            slip = next;
            direction.iter_mut().zip(&*ahead).for_each(|(direction, ahead)| *direction = ahead + turn * *direction);
            image.iter_mut().zip(&*residual).for_each(|(image, residual)| *image = residual + turn * *image);
            sweeps += 1;
        }
        ahead.iter_mut().zip(&*potential).for_each(|(ahead, potential)| *ahead += potential);
        let (mut pressure_gradient, per_secs) = match pressure_gradient {
            Some((pressure_gradient, per_secs)) => (Some(pressure_gradient), R::of(per_secs)),
            None => (None, R::zero()),
        };
        for (axis, field) in velocity.0.iter_mut().enumerate() {
            let pressure_gradient = pressure_gradient.as_mut().map(|pressure_gradient| &mut pressure_gradient.0[axis].data[..]);
            subtract_gradient(grid, ahead, axis, &mut field.data, pressure_gradient, per_secs);
        }
        bear_pressure(grid, walls, potential, velocity);
        if enclosed.iter().any(|(_, apart)| *apart != 0.0) {
            ahead.fill(elsewhere);
            push_through(grid, separable, enclosed, ahead, velocity);
        }
        Convergence { residual: (slip.max(0.0) / scale.max(f64::MIN_POSITIVE)).sqrt(), sweeps, tolerance: SLIP }
    }
}

/// Sets apart the residual of cells on whose faces no pressure acts, as walls hold them or the box is closed there, and lists it; then the mean of that of all other cells, if no
/// air leaves the box, which it returns (1/s). `held` is a work array.
fn set_apart<R: Real>(grid: &Grid<R>, walls: &Walls<R>, held: &mut [f64], residual: &mut [f64], enclosed: &mut Vec<(usize, f64)>) -> f64 {
    enclosed.clear();
    held.fill(0.0);
    for face in walls.faces.iter().flatten().filter(|face| face.held == 1.0) {
        face.cells.into_iter().for_each(|cell| held[cell] += 1.0);
    }
    let [nx, ny, _] = grid.cells;
    let open = |cell: usize| {
        let index = [cell % nx, cell / nx % ny, cell / (nx * ny)];
        let faces = (0..3).map(|axis| {
            let free = grid.free(Location::Face(axis), axis);
            (index[axis]..index[axis] + 2).filter(|face| grid.wraps(axis) || free.contains(face)).count()
        });
        faces.sum::<usize>() as f64
    };
    for (cell, residual) in residual.iter_mut().enumerate() {
        if held[cell] > 0.0 && held[cell] >= open(cell) {
            enclosed.push((cell, std::mem::take(residual)));
        }
    }
    let is_closed = !grid.boundary.iter().flatten().any(|face| face.fixes_pressure());
    let others = residual.len() - enclosed.len();
    if !is_closed || enclosed.is_empty() || others == 0 {
        return 0.0;
    }
    let mean = residual.iter().sum::<f64>() / others as f64;
    residual.iter_mut().for_each(|residual| *residual -= mean);
    enclosed.iter().for_each(|&(cell, _)| residual[cell] = 0.0);
    mean
}

/// Moves the air that is set apart through the walls: what the list says in enclosed cells, and `apart` (1/s) elsewhere, which becomes its potential.
fn push_through<R: Real>(
    grid: &Grid<R>,
    separable: &mut Separable,
    enclosed: &[(usize, f64)],
    apart: &mut [f64],
    velocity: &mut Velocity<R>,
) {
    enclosed.iter().for_each(|&(cell, residual)| apart[cell] = residual);
    separable.solve(0.0, apart);
    for (axis, field) in velocity.0.iter_mut().enumerate() {
        subtract_gradient(grid, apart, axis, &mut field.data, None, R::zero());
    }
}

/// Sum over the faces of walls of `(1 − β)·|∇p|²`.
fn held_energy<R: Real>(grid: &Grid<R>, walls: &Walls<R>, p: &[f64]) -> f64 {
    let along = |axis: usize| {
        let per_m = grid.spacing_m[axis].wide().recip();
        walls.faces[axis].iter().map(move |face| {
            let slope = (p[face.cells[1]] - p[face.cells[0]]) * per_m;
            face.held * slope * slope
        })
    };
    (0..3).flat_map(along).sum()
}

/// Subtracts `length·∇·(1 − β)∇p` from `residual`: with `length` times −∇²p it makes `length` times the image of p under −∇·β∇.
fn give_back<R: Real>(grid: &Grid<R>, walls: &Walls<R>, p: &[f64], length: f64, residual: &mut [f64]) {
    for (faces, spacing_m) in walls.faces.iter().zip(grid.spacing_m) {
        let per_m2 = (spacing_m * spacing_m).wide().recip();
        for face in faces {
            let [before, behind] = face.cells;
            let flux = length * face.held * (p[behind] - p[before]) * per_m2;
            residual[before] -= flux;
            residual[behind] += flux;
        }
    }
}

/// Returns to the faces of walls the share of the pressure gradient that the walls bear, and adds up the momentum that they have taken.
fn bear_pressure<R: Real>(grid: &Grid<R>, walls: &mut Walls<R>, potential: &[f64], velocity: &mut Velocity<R>) {
    let cell_m3: f64 = grid.spacing_m.iter().map(|h| h.wide()).product();
    for axis in 0..3 {
        let per_m = grid.spacing_m[axis].wide().recip();
        let mut given = 0.0;
        for face in &walls.faces[axis] {
            let borne = R::of(face.held * (potential[face.cells[1]] - potential[face.cells[0]]) * per_m);
            let speed = &mut velocity.0[axis].data[face.at];
            *speed = *speed + borne;
            given += (face.gain + borne).wide();
        }
        walls.impulse_m4_per_s[axis] = -given * cell_m3;
    }
}
