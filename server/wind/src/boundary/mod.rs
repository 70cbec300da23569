//! Boundary conditions: the values at and beyond the faces of the box and of solid cells.

pub(crate) mod condition;
pub(crate) mod friction;
mod ghosts;
mod inflow;
pub(crate) mod outflow;
#[cfg(test)]
mod tests;

pub use condition::Boundary;
pub use inflow::Prescribed;

use crate::field::{Field, Velocity};
use crate::grid::{GHOST, Grid, Location};
use crate::real::Real;
use ghosts::{Rule, fill};
use inflow::Inflow;

/// Sets the values of fields that are given by boundary conditions: normal velocities on closed and prescribed faces, ghosts, and the faces of solid cells.
///
/// Ghosts are second-order mirror images: `2w − image` where the face has the value w, the image itself where the gradient is 0. They are filled along x, then y,
/// then z, so that edges and corners are consistent.
///
/// Friction next to a face with a given tangential velocity takes its second difference from a parabola through w instead (`friction.rs`).
pub struct BoundaryConditions<R> {
    grid: Grid<R>,
    inflow: Vec<Inflow<R>>,
    prescribed: Prescribed,
    /// For each component, the indices in memory of the faces next to a solid cell.
    solid_faces: [Vec<usize>; 3],
    /// Whether air beyond outflow faces is at rest where it flows back in.
    backflow_rests: bool,
}

/// Values on and beyond inflow faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InflowGhosts {
    /// The prescribed velocity: for a velocity that has been projected.
    Prescribed,
    /// Linear extrapolation from the two nearest interior values: for an intermediate velocity, before the pressure gradient is applied. Prescribed
    /// values include that gradient and would be off by `dt·∇p`.
    Extrapolated,
    /// Ghost values are not changed.
    Unchanged,
}

impl<R: Real> BoundaryConditions<R> {
    /// The boundary conditions of `grid`, with the velocity `prescribed` on inflow faces.
    pub fn new(grid: &Grid<R>, prescribed: Prescribed) -> Self {
        let mut boundaries =
            Self { grid: *grid, inflow: Inflow::of_faces(grid), prescribed, solid_faces: Default::default(), backflow_rests: true };
        boundaries.update_inflow(0.0);
        boundaries
    }

    /// Gives air beyond outflow faces the velocity at the face, also where it flows back in: transport by fluxes corrects what such air brings
    /// ([`outflow::correct_flux`]).
    pub(super) fn continue_backflow(&mut self) {
        self.backflow_rests = false;
    }

    /// Memory of the values on inflow faces and of the list of solid cells' faces (bytes).
    pub(super) fn memory_bytes(&self) -> usize {
        let inflow: usize = self.inflow.iter().flat_map(|face| &face.doubled).map(|values| size_of_val(values.as_slice())).sum();
        inflow + self.solid_faces.iter().map(|faces| faces.capacity() * size_of::<usize>()).sum::<usize>()
    }

    /// Changes the velocity prescribed on inflow faces.
    pub fn set_inflow(&mut self, prescribed: Prescribed) {
        self.prescribed = prescribed;
    }

    /// Evaluates the velocity on inflow faces at a time (s). In a box without outflow, the normal velocity on all inflow faces is shifted to zero net
    /// flux, the compatibility condition of the pressure equation.
    pub fn update_inflow(&mut self, time_secs: f64) {
        self.inflow.iter_mut().for_each(|face| face.evaluate(&self.grid, &self.prescribed, time_secs));
        let has_outflow = self.grid.boundary.iter().flatten().any(|face| face.fixes_pressure());
        if !has_outflow && !self.inflow.is_empty() {
            inflow::balance(&self.grid, &mut self.inflow);
        }
    }

    /// Marks cells as solid: `solid` has one entry per cell, x fastest.
    pub fn set_solid(&mut self, solid: &[bool]) {
        let grid = self.grid;
        let [nx, ny, nz] = grid.cells;
        for (axis, faces) in self.solid_faces.iter_mut().enumerate() {
            faces.clear();
            for n in (0..nx * ny * nz).filter(|&n| solid[n]) {
                let near = [n % nx, n / nx % ny, n / (nx * ny)];
                let mut far = near;
                far[axis] += 1;
                if far[axis] == grid.cells[axis] && grid.wraps(axis) {
                    far[axis] = 0;
                }
                faces.extend([grid.at(near), grid.at(far)]);
            }
            faces.sort_unstable();
            faces.dedup();
        }
    }

    /// Applies all boundary conditions to a staggered velocity.
    pub fn apply(&self, velocity: &mut Velocity<R>) {
        self.apply_with(velocity, InflowGhosts::Prescribed);
    }

    /// [`BoundaryConditions::apply`] with a choice of the values on inflow faces.
    pub fn apply_with(&self, velocity: &mut Velocity<R>, inflow: InflowGhosts) {
        for field in &mut velocity.0 {
            self.apply_to_component_with(field, inflow);
        }
        for axis in 0..3 {
            for side in [0, 1] {
                if self.backflow_rests && self.grid.boundary[axis][side].fixes_pressure() {
                    self.zero_backflow(velocity, axis, side);
                }
            }
        }
    }

    /// [`BoundaryConditions::apply`] for one component.
    pub fn apply_to_component(&self, field: &mut Field<R>) {
        self.apply_to_component_with(field, InflowGhosts::Prescribed);
    }

    /// [`BoundaryConditions::apply_with`] for one component.
    pub fn apply_to_component_with(&self, field: &mut Field<R>, inflow: InflowGhosts) {
        let Location::Face(component) = field.location else { unreachable!("velocity components are on faces") };
        // Before the ghosts, so that periodic images include solid faces; after them, for faces on the boundary itself.
        self.zero_solid_faces(field, component);
        for axis in 0..3 {
            let keeps = |side: usize| self.grid.boundary[axis][side] == Boundary::Inflow && inflow != InflowGhosts::Prescribed;
            let rules = [0, 1].map(|side| if keeps(side) { Rule::Keep } else { self.velocity_rule(component, axis, side) });
            fill(&self.grid, field, axis, rules);
            (0..2).filter(|&side| keeps(side) && inflow == InflowGhosts::Extrapolated).for_each(|side| self.extrapolate(field, axis, side));
        }
        self.zero_solid_faces(field, component);
    }

    /// Fills the ghosts of a concentration.
    pub fn apply_to_concentration(&self, field: &mut Field<R>) {
        for axis in 0..3 {
            let rules = self.grid.boundary[axis].map(|face| Rule::new(face.concentration_ghosts(), || &[]));
            fill(&self.grid, field, axis, rules);
        }
    }

    fn velocity_rule(&self, component: usize, axis: usize, side: usize) -> Rule<'_, R> {
        let prescribed = || {
            let face = self.inflow.iter().find(|inflow| inflow.axis == axis && inflow.side == side);
            &face.expect("every inflow face has its values").doubled[component][..]
        };
        Rule::new(self.grid.boundary[axis][side].velocity_ghosts(component, component == axis), prescribed)
    }

    /// Extrapolates linearly from the two values nearest to a face; in a box with a single cell, from one.
    fn extrapolate(&self, field: &mut Field<R>, axis: usize, side: usize) {
        let (grid, n, stride) = (&self.grid, self.grid.cells[axis], self.grid.strides()[axis]);
        let free = grid.free(field.location, axis);
        let Some(last) = free.clone().last() else { return };
        let [near, next] =
            if side == 0 { [free.start, (free.start + 1).min(last)] } else { [last, last.saturating_sub(1).max(free.start)] };
        let outside = if side == 0 { 0..near + GHOST } else { near + GHOST + 1..n + 2 * GHOST + 1 };
        for line in field.data.chunks_mut(stride * grid.padded()[axis]) {
            for inner in 0..stride {
                let at = |index: usize| index * stride + inner;
                let (here, slope) = (line[at(near + GHOST)], line[at(near + GHOST)] - line[at(next + GHOST)]);
                for index in outside.clone() {
                    line[at(index)] = here + R::of(index.abs_diff(near + GHOST) as f64) * slope;
                }
            }
        }
    }

    /// Sets the ghosts beyond an outflow face to 0 where air flows back in. A trajectory from there would carry ever faster air if the ghosts had its velocity.
    fn zero_backflow(&self, velocity: &mut Velocity<R>, axis: usize, side: usize) {
        let (grid, strides) = (&self.grid, self.grid.strides());
        let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
        let n = grid.cells[axis];
        let (node, outside) = if side == 0 { (GHOST, [GHOST - 1, GHOST - 2]) } else { (GHOST + n, [GHOST + n, GHOST + n + 1]) };
        for m in GHOST..GHOST + grid.cells[a] + 1 {
            for l in GHOST..GHOST + grid.cells[b] + 1 {
                let at = |index: usize| index * strides[axis] + m * strides[a] + l * strides[b];
                let through = velocity.0[axis].data[at(node)];
                let flows_in = if side == 0 { through > R::zero() } else { through < R::zero() };
                if flows_in {
                    for component in [a, b] {
                        outside.iter().for_each(|&index| velocity.0[component].data[at(index)] = R::zero());
                    }
                    let beyond = if side == 0 { outside } else { outside.map(|index| index + 1) };
                    beyond.iter().for_each(|&index| velocity.0[axis].data[at(index)] = R::zero());
                }
            }
        }
    }

    fn zero_solid_faces(&self, field: &mut Field<R>, component: usize) {
        self.solid_faces[component].iter().for_each(|&at| field.data[at] = R::zero());
    }
}
