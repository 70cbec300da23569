//! What a step must know about itself: speed, energy, divergence, and that every number is one.

use super::parallel::for_each_chunk_pair;
use super::{Grid, Real, Velocity};

/// The state of the flow after a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Health {
    /// Largest `|u|·dt/h` of any cell and axis.
    pub courant: f64,
    /// Root mean square of the divergence over that of `|u|/h`, h the smallest spacing; 0 for air at rest.
    pub divergence_rms_rel: f64,
    /// Mean of `|u|²/2` (m²/s²): kinetic energy per mass of air.
    pub kinetic_energy_m2_per_s2: f64,
}

/// Sums over one plane of cells.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlaneSums {
    courant: f64,
    divergence_squares: f64,
    speed_squares: f64,
}

/// Fills `centres` with the velocity (m/s) at every cell's centre (mean of its faces, second order; the fourth number is 0) and measures the flow on the way.
/// `planes` has one entry per plane of cells along z.
pub fn measure<R: Real>(grid: &Grid<R>, velocity: &Velocity<R>, dt_secs: R, centres: &mut [[R; 4]], planes: &mut [PlaneSums]) -> Health {
    let [nx, ny, _] = grid.cells;
    let [u, v, w] = &velocity.0;
    let half = R::of(0.5);
    let per_m = grid.spacing_m.map(R::recip);
    for_each_chunk_pair(centres, nx * ny, planes, 1, |k, centres, sums| {
        let (mut fastest, mut divergence_squares, mut speed_squares) = ([R::zero(); 3], 0.0, 0.0);
        let k_far = grid.far_face(2, k);
        for (j, row) in centres.chunks_mut(nx).enumerate() {
            let j_far = grid.far_face(1, j);
            let along_x = &u.data[u.index([0, j, k])..][..u.shape[0]];
            let [down, up] = [j, j_far].map(|j| &v.data[v.index([0, j, k])..][..nx]);
            let [south, north] = [k, k_far].map(|k| &w.data[w.index([0, j, k])..][..nx]);
            let (mut row_divergence, mut row_speed) = (R::zero(), R::zero());
            for (i, centre) in row.iter_mut().enumerate() {
                let faces = [[along_x[i], along_x[grid.far_face(0, i)]], [down[i], up[i]], [south[i], north[i]]];
                let outflow: [R; 3] = std::array::from_fn(|axis| (faces[axis][1] - faces[axis][0]) * per_m[axis]);
                let [x, y, z] = faces.map(|[near, far]| half * (near + far));
                *centre = [x, y, z, R::zero()];
                for (fastest, speed) in fastest.iter_mut().zip([x, y, z]) {
                    *fastest = if speed.abs() > *fastest { speed.abs() } else { *fastest };
                }
                let divergence = outflow[0] + outflow[1] + outflow[2];
                row_divergence = row_divergence + divergence * divergence;
                row_speed = row_speed + (x * x + y * y + z * z);
            }
            divergence_squares += row_divergence.wide();
            speed_squares += row_speed.wide();
        }
        let courant = (0..3).map(|axis| (fastest[axis] * dt_secs * per_m[axis]).wide()).fold(0.0, f64::max);
        sums[0] = PlaneSums { courant, divergence_squares, speed_squares };
    });
    let total = planes.iter().fold(PlaneSums::default(), |a, b| PlaneSums {
        courant: a.courant.max(b.courant),
        divergence_squares: a.divergence_squares + b.divergence_squares,
        speed_squares: a.speed_squares + b.speed_squares,
    });
    let smallest_m = grid.spacing_m.iter().fold(R::infinity(), |a, &h| a.min(h)).wide();
    let at_rest = total.speed_squares == 0.0;
    Health {
        courant: total.courant,
        divergence_rms_rel: if at_rest { 0.0 } else { (total.divergence_squares / total.speed_squares).sqrt() * smallest_m },
        kinetic_energy_m2_per_s2: 0.5 * total.speed_squares / grid.len() as f64,
    }
}

/// The first cell whose velocity is not a finite number.
pub fn first_bad_cell<R: Real>(grid: &Grid<R>, centres: &[[R; 4]]) -> Option<[usize; 3]> {
    let [nx, ny, _] = grid.cells;
    let at = centres.iter().position(|velocity| velocity.iter().any(|x| !x.is_finite()))?;
    Some([at % nx, at / nx % ny, at / (nx * ny)])
}
