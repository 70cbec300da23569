//! Where the air in a cell came from, and where it goes.

use super::parallel::for_each_chunk_pair;
use super::sample::{self, Stencil};
use super::{Grid, Real};

/// Displacements (cells along x, y, z; the fourth number is 0) of the air at each cell's centre over one step.
#[derive(Clone, Debug)]
pub struct Paths<R> {
    /// From now to where the air was a step ago.
    pub back: Vec<[R; 4]>,
    /// From now to where the air will be a step later.
    pub ahead: Vec<[R; 4]>,
}

impl<R: Real> Paths<R> {
    /// Paths of air at rest.
    pub fn zeros(grid: &Grid<R>) -> Self {
        let rest = vec![[R::zero(); 4]; grid.len()];
        Self { back: rest.clone(), ahead: rest }
    }
}

/// Traces the air at every cell's centre through `centres`, the velocity (m/s) there, held for `dt_secs`.
///
/// Midpoint rule (Runge–Kutta 2): the path back is `−dt·u(x − dt/2·u(x))`, with an error of third order in dt. The path ahead needs
/// `u(x + dt/2·u(x))`, which is `2u(x) − u(x − dt/2·u(x))` up to second order and so costs no second look. One trace per cell serves every field: faces take
/// the mean of the two cells they part, which is second order in h.
pub fn trace<R: Real>(grid: &Grid<R>, centres: &[[R; 4]], dt_secs: R, paths: &mut Paths<R>) {
    let [nx, ny, _] = grid.cells;
    let per_cell: [R; 3] = grid.spacing_m.map(|h| dt_secs / h);
    let per_cell = [per_cell[0], per_cell[1], per_cell[2], R::zero()];
    let two = R::of(2.0);
    let half = R::of(0.5);
    let wraps = [0, 1, 2].map(|axis| grid.wraps(axis));
    for_each_chunk_pair(&mut paths.back, nx * ny, &mut paths.ahead, nx * ny, |k, back, ahead| {
        for j in 0..ny {
            for i in 0..nx {
                let here = centres[i + nx * (j + ny * k)];
                let midway: [R; 3] = std::array::from_fn(|c| -half * per_cell[c] * here[c]);
                let stencils = [
                    Stencil::new(i, midway[0], nx, wraps[0]),
                    Stencil::new(j, midway[1], ny, wraps[1]),
                    Stencil::new(k, midway[2], grid.cells[2], wraps[2]),
                ];
                let there = sample::trilinear(centres, grid.cells, &stencils);
                back[i + nx * j] = std::array::from_fn(|c| -per_cell[c] * there[c]);
                ahead[i + nx * j] = std::array::from_fn(|c| per_cell[c] * (two * here[c] - there[c]));
            }
        }
    });
}
