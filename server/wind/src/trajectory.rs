//! Trajectories of the air over one step.

use super::parallel::for_each_chunk_pair;
use super::sample::{self, Ends, Stencil};
use super::{GHOST, Grid, Location, Real};

/// Displacements (cells along x, y, z; the fourth number is 0) of the air at each cell centre over one step, in memory order, with one layer of ghosts.
#[derive(Clone, Debug)]
pub struct Trajectories<R> {
    /// To the position one step ago.
    pub backward: Vec<[R; 4]>,
    /// To the position one step later.
    pub forward: Vec<[R; 4]>,
}

impl<R: Real> Trajectories<R> {
    /// Trajectories of air at rest; `len` is the number of values of a field in memory.
    pub fn at_rest(len: usize) -> Self {
        let rest = vec![[R::zero(); 4]; len];
        Self { backward: rest.clone(), forward: rest }
    }
}

/// Traces the air at every cell centre and at the first layer of ghosts through `centres`, the velocity (m/s) there, constant over `dt_secs`.
///
/// Midpoint rule (Runge–Kutta 2): the backward displacement is `−dt·u(x − dt/2·u(x))`, with a third-order error in dt. The forward one needs
/// `u(x + dt/2·u(x))`, which equals `2u(x) − u(x − dt/2·u(x))` to second order and so needs no second interpolation. One trace per cell serves every field:
/// faces take the mean of the two adjacent cells, which is second order in h.
pub fn trace<R: Real>(grid: &Grid<R>, centres: &[[R; 4]], dt_secs: f64, trajectories: &mut Trajectories<R>) {
    let [nx, ny, nz] = grid.cells;
    let strides = grid.strides();
    let per_cell = grid.spacing_m.map(|h| R::of(dt_secs) / h);
    let per_cell = [per_cell[0], per_cell[1], per_cell[2], R::zero()];
    let (two, half) = (R::of(2.0), R::of(0.5));
    let ends: [Ends<R>; 3] = std::array::from_fn(|axis| Ends::of(grid, Location::Centre, axis));
    let planes = strides[2] * (GHOST - 1)..strides[2] * (nz + GHOST + 1);
    let (back, ahead) = (&mut trajectories.backward[planes.clone()], &mut trajectories.forward[planes]);
    for_each_chunk_pair(back, strides[2], ahead, strides[2], |plane, back, ahead| {
        for j in 0..ny + 2 {
            let row = strides[1] * (j + GHOST - 1);
            for i in 0..nx + 2 {
                let at = i + GHOST - 1 + row;
                let here = centres[at + strides[2] * (plane + GHOST - 1)];
                let stencils = [(0, i), (1, j), (2, plane)].map(|(axis, index)| {
                    // Relative to the first ghost, so that the index is not negative.
                    Stencil::new(index, -half * per_cell[axis] * here[axis] - R::one(), ends[axis])
                });
                let there = sample::trilinear(centres, strides, &stencils);
                back[at] = std::array::from_fn(|c| -per_cell[c] * there[c]);
                ahead[at] = std::array::from_fn(|c| per_cell[c] * (two * here[c] - there[c]));
            }
        }
    });
}
