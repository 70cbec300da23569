//! Where the air in a cell came from, and where it goes.

use super::parallel::for_each_chunk_pair;
use super::sample::{self, Ends, Stencil};
use super::{GHOST, Grid, Place, Real};

/// Displacements (cells along x, y, z; the fourth number is 0) of the air at each cell's centre over one step, in memory order with one ghost filled.
#[derive(Clone, Debug)]
pub struct Paths<R> {
    /// From now to where the air was a step ago.
    pub back: Vec<[R; 4]>,
    /// From now to where the air will be a step later.
    pub ahead: Vec<[R; 4]>,
}

impl<R: Real> Paths<R> {
    /// Paths of air at rest, as many as a field has values in memory.
    pub fn at_rest(len: usize) -> Self {
        let rest = vec![[R::zero(); 4]; len];
        Self { back: rest.clone(), ahead: rest }
    }
}

/// Traces the air at every cell's centre, and at the first ghosts beyond, through `centres`, the velocity (m/s) there, held for `dt_secs`.
///
/// Midpoint rule (Runge–Kutta 2): the path back is `−dt·u(x − dt/2·u(x))`, with an error of third order in dt. The path ahead needs
/// `u(x + dt/2·u(x))`, which is `2u(x) − u(x − dt/2·u(x))` up to second order and so costs no second look. One trace per cell serves every field: faces take
/// the mean of the two cells they part, which is second order in h.
pub fn trace<R: Real>(grid: &Grid<R>, centres: &[[R; 4]], dt_secs: f64, paths: &mut Paths<R>) {
    let [nx, ny, nz] = grid.cells;
    let strides = grid.strides();
    let per_cell = grid.spacing_m.map(|h| R::of(dt_secs) / h);
    let per_cell = [per_cell[0], per_cell[1], per_cell[2], R::zero()];
    let (two, half) = (R::of(2.0), R::of(0.5));
    let ends: [Ends<R>; 3] = std::array::from_fn(|axis| Ends::of(grid, Place::Centre, axis));
    let planes = strides[2] * (GHOST - 1)..strides[2] * (nz + GHOST + 1);
    let (back, ahead) = (&mut paths.back[planes.clone()], &mut paths.ahead[planes]);
    for_each_chunk_pair(back, strides[2], ahead, strides[2], |plane, back, ahead| {
        for j in 0..ny + 2 {
            let row = strides[1] * (j + GHOST - 1);
            for i in 0..nx + 2 {
                let at = i + GHOST - 1 + row;
                let here = centres[at + strides[2] * (plane + GHOST - 1)];
                let stencils = [(0, i), (1, j), (2, plane)].map(|(axis, index)| {
                    // Counted from the first ghost, so that the index is no negative number.
                    Stencil::new(index, -half * per_cell[axis] * here[axis] - R::one(), ends[axis])
                });
                let there = sample::trilinear(centres, strides, &stencils);
                back[at] = std::array::from_fn(|c| -per_cell[c] * there[c]);
                ahead[at] = std::array::from_fn(|c| per_cell[c] * (two * here[c] - there[c]));
            }
        }
    });
}
