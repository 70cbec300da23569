//! Step diagnostics: speed, kinetic energy, relative divergence, finiteness.

use multiversion::multiversion;

use super::parallel::for_each_chunk;
use super::{Field, GHOST, Grid, Real, Velocity};

/// Number of partial sums of a row.
const LANES: usize = 8;

/// Diagnostics of a velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Diagnostics {
    /// Largest speed (m/s) along each axis.
    pub max_speed_m_per_s: [f64; 3],
    /// Relative divergence (dimensionless): rms of `∇·u` over the rms of `|u|/h`, h the smallest spacing; 0 for air at rest.
    pub divergence_rms_rel: f64,
    /// Mean kinetic energy per mass, `|u|²/2` (m²/s²).
    pub kinetic_energy_m2_per_s2: f64,
}

/// Sums over one plane of cells.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlaneSums {
    max_speed_m_per_s: [f64; 3],
    divergence_squares: f64,
    speed_squares: f64,
}

/// Interpolates the velocity (m/s) to every cell centre and the first layer of ghosts (mean of two faces, second order; the fourth number is 0), in memory
/// order. The velocity's ghosts must be filled.
pub fn interpolate_to_centres<R: Real>(grid: &Grid<R>, velocity: &Velocity<R>, centres: &mut [[R; 4]]) {
    let strides = grid.strides();
    let [nx, ny, nz] = grid.cells;
    let half = R::of(0.5);
    let planes = strides[2] * (GHOST - 1)..strides[2] * (nz + GHOST + 1);
    for_each_chunk(&mut centres[planes], strides[2], |plane, centres| {
        for j in GHOST - 1..ny + GHOST + 1 {
            let row = GHOST - 1 + strides[1] * j;
            let at = row + strides[2] * (plane + GHOST - 1);
            let [u, v, w] = [0, 1, 2].map(|axis| {
                let data = &velocity.0[axis].data;
                [&data[at..][..nx + 2], &data[at + strides[axis]..][..nx + 2]]
            });
            for (i, centre) in centres[row..][..nx + 2].iter_mut().enumerate() {
                *centre = [half * (u[0][i] + u[1][i]), half * (v[0][i] + v[1][i]), half * (w[0][i] + w[1][i]), R::zero()];
            }
        }
    });
}

/// Computes the diagnostics. `planes` has one entry per plane of cells along z.
pub fn measure<R: Real>(grid: &Grid<R>, velocity: &Velocity<R>, planes: &mut [PlaneSums]) -> Diagnostics {
    for_each_chunk(planes, 1, |k, sums| sums[0] = measure_plane(grid, velocity, k));
    let total = planes.iter().fold(PlaneSums::default(), |a, b| PlaneSums {
        max_speed_m_per_s: [0, 1, 2].map(|axis| a.max_speed_m_per_s[axis].max(b.max_speed_m_per_s[axis])),
        divergence_squares: a.divergence_squares + b.divergence_squares,
        speed_squares: a.speed_squares + b.speed_squares,
    });
    let spacing_m = grid.spacing_m.map(R::wide);
    let smallest_m = spacing_m.into_iter().fold(f64::INFINITY, f64::min);
    let at_rest = total.speed_squares == 0.0;
    Diagnostics {
        max_speed_m_per_s: total.max_speed_m_per_s,
        divergence_rms_rel: if at_rest { 0.0 } else { (total.divergence_squares / total.speed_squares).sqrt() * smallest_m },
        kinetic_energy_m2_per_s2: 0.5 * total.speed_squares / grid.len() as f64,
    }
}

/// Largest speed (m/s) of any face along each axis, now or after `acceleration` (m/s²) has acted for `dt_secs` (s) in either direction.
pub fn largest_speeds<R: Real>(grid: &Grid<R>, velocity: &Velocity<R>, acceleration: &Velocity<R>, dt_secs: f64) -> [f64; 3] {
    [0, 1, 2].map(|axis| fastest_component(grid, &velocity.0[axis], &acceleration.0[axis].data, R::of(dt_secs)).wide())
}

#[multiversion(targets("x86_64+avx2"))]
fn fastest_component<R: Real>(grid: &Grid<R>, speeds: &Field<R>, acceleration: &[R], dt: R) -> R {
    let n = speeds.shape[0];
    let mut fastest = [R::zero(); LANES];
    for at in speeds.rows(grid) {
        let (speeds, acceleration) = (&speeds.data[at..][..n], &acceleration[at..][..n]);
        let mut take = |i: usize, lane: usize| {
            let speed = speeds[i].abs() + dt * acceleration[i].abs();
            fastest[lane] = if speed > fastest[lane] { speed } else { fastest[lane] };
        };
        let whole = n - n % LANES;
        for start in (0..whole).step_by(LANES) {
            (0..LANES).for_each(|lane| take(start + lane, lane));
        }
        (whole..n).for_each(|i| take(i, i - whole));
    }
    fastest.into_iter().fold(R::zero(), |a, b| if b > a { b } else { a })
}

/// Uses partial sums and extremes, so that the compiler can vectorise; they are reduced in a fixed order.
#[multiversion(targets("x86_64+avx2"))]
fn measure_plane<R: Real>(grid: &Grid<R>, velocity: &Velocity<R>, k: usize) -> PlaneSums {
    let [nx, ny, _] = grid.cells;
    let strides = grid.strides();
    let per_m = grid.spacing_m.map(R::recip);
    let half = R::of(0.5);
    let mut fastest = [[R::zero(); LANES]; 3];
    let (mut divergence_squares, mut speed_squares) = (0.0, 0.0);
    for j in 0..ny {
        let at = grid.at([0, j, k]);
        let faces = [0, 1, 2].map(|axis| {
            let data = &velocity.0[axis].data;
            [&data[at..][..nx], &data[at + strides[axis]..][..nx]]
        });
        let (mut divergences, mut speeds) = ([R::zero(); LANES], [R::zero(); LANES]);
        let mut add = |i: usize, lane: usize| {
            let [[u0, u1], [v0, v1], [w0, w1]] = faces.map(|[low, high]| [low[i], high[i]]);
            let divergence = (u1 - u0) * per_m[0] + (v1 - v0) * per_m[1] + (w1 - w0) * per_m[2];
            let centre = [half * (u0 + u1), half * (v0 + v1), half * (w0 + w1)];
            for (fastest, speed) in fastest.iter_mut().zip(centre) {
                let speed = speed.abs();
                fastest[lane] = if speed > fastest[lane] { speed } else { fastest[lane] };
            }
            divergences[lane] = divergences[lane] + divergence * divergence;
            speeds[lane] = speeds[lane] + (centre[0] * centre[0] + centre[1] * centre[1] + centre[2] * centre[2]);
        };
        let whole = nx - nx % LANES;
        for start in (0..whole).step_by(LANES) {
            (0..LANES).for_each(|lane| add(start + lane, lane));
        }
        (whole..nx).for_each(|i| add(i, i - whole));
        divergence_squares += divergences.into_iter().map(R::wide).sum::<f64>();
        speed_squares += speeds.into_iter().map(R::wide).sum::<f64>();
    }
    let max_speed_m_per_s = fastest.map(|lanes| lanes.into_iter().map(R::wide).fold(0.0, f64::max));
    PlaneSums { max_speed_m_per_s, divergence_squares, speed_squares }
}

/// The first cell, along x, then y, then z, whose velocity is NaN or infinite.
pub fn first_non_finite_cell<R: Real>(grid: &Grid<R>, velocity: &Velocity<R>) -> Option<[usize; 3]> {
    let [nx, ny, nz] = grid.cells;
    let strides = grid.strides();
    let is_bad = |at: usize| (0..3).any(|axis| [0, strides[axis]].iter().any(|step| !velocity.0[axis].data[at + step].is_finite()));
    (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k]))).find(|&cell| is_bad(grid.at(cell)))
}
