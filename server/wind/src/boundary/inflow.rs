//! Prescribed velocity on inflow faces.

use super::condition::Boundary;
use crate::grid::{GHOST, Grid, Location};
use crate::real::Real;

/// A velocity (m/s) as a function of position (m) and time (s).
pub type Prescribed = Box<dyn Fn([f64; 3], f64) -> [f64; 3] + Send + Sync>;

/// Velocity on one inflow face.
pub(super) struct Inflow<R> {
    pub(super) axis: usize,
    pub(super) side: usize,
    /// Twice the velocity of each component over the plane of the face, in memory order.
    pub(super) doubled: [Vec<R>; 3],
}

impl<R: Real> Inflow<R> {
    /// Allocates the values of every inflow face of `grid`.
    pub(super) fn of_faces(grid: &Grid<R>) -> Vec<Self> {
        let plane_len = |axis: usize| grid.padded_len() / grid.padded()[axis];
        let faces = (0..3).flat_map(|axis| [0, 1].map(|side| (axis, side)));
        let inflow = faces.filter(|&(axis, side)| grid.boundary[axis][side] == Boundary::Inflow);
        inflow.map(|(axis, side)| Self { axis, side, doubled: std::array::from_fn(|_| vec![R::zero(); plane_len(axis)]) }).collect()
    }

    /// Evaluates `prescribed` at a time (s).
    pub(super) fn evaluate(&mut self, grid: &Grid<R>, prescribed: &Prescribed, time_secs: f64) {
        let (axis, side) = (self.axis, self.side);
        let across = tangential(axis);
        let len = across.map(|a| grid.padded()[a]);
        for (component, plane) in self.doubled.iter_mut().enumerate() {
            for (n, value) in plane.iter_mut().enumerate() {
                let mut position = [0.0; 3];
                position[axis] = if side == 0 { 0.0 } else { grid.extent_m(axis).wide() };
                for (a, index) in across.into_iter().zip([n % len[0], n / len[0]]) {
                    let offset = grid.offset(Location::Face(component), a).wide();
                    position[a] = (index as f64 - GHOST as f64 + offset) * grid.spacing_m[a].wide();
                }
                *value = R::of(2.0 * prescribed(position, time_secs)[component]);
            }
        }
    }
}

/// Shifts the normal velocity on all inflow faces so that their net flux is 0.
pub(super) fn balance<R: Real>(grid: &Grid<R>, faces: &mut [Inflow<R>]) {
    let inner = |axis: usize| {
        let [a, b] = tangential(axis);
        let row = grid.padded()[a];
        let cell_m2 = grid.spacing_m[a].wide() * grid.spacing_m[b].wide();
        let at = (0..grid.cells[b]).flat_map(move |k| (0..grid.cells[a]).map(move |i| i + GHOST + row * (k + GHOST)));
        (at, cell_m2)
    };
    let (mut doubled_out, mut area_m2) = (0.0, 0.0);
    for Inflow { axis, side, doubled } in &*faces {
        let outward = if *side == 0 { -1.0 } else { 1.0 };
        let (at, cell_m2) = inner(*axis);
        for n in at {
            doubled_out += outward * doubled[*axis][n].wide() * cell_m2;
            area_m2 += cell_m2;
        }
    }
    for Inflow { axis, side, doubled } in faces {
        let inward = if *side == 0 { 1.0 } else { -1.0 };
        let shift = R::of(inward * doubled_out / area_m2);
        doubled[*axis].iter_mut().for_each(|value| *value = *value + shift);
    }
}

/// The two axes along a face, in memory order.
fn tangential(axis: usize) -> [usize; 2] {
    match axis {
        0 => [1, 2],
        1 => [0, 2],
        _ => [0, 1],
    }
}
