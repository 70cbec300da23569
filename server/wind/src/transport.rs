//! Conservative transport by fluxes through cell faces: the flux out of a cell is exactly the flux into its neighbour.
//!
//! Momentum has central fluxes on the staggered grid (Harlow & Welch 1965), second order, which conserve kinetic energy in divergence-free air, plus
//! an upwind fourth difference that damps waves of two cells. Concentrations have limited linear reconstruction (van Leer 1979;
//! monotonised central limiter), second order where smooth, without new extrema. Time integration is the third-order Runge–Kutta scheme of Shu &
//! Osher 1988.
//!
//! A stage of a component takes about 50 operations and 13 reads from cache per value. Several rows, with the ghosts between them, are processed as one long line of
//! memory, so that short rows cost no more than long ones. Values written into ghosts are overwritten by the boundary conditions.

use multiversion::multiversion;

use super::boundary::friction::largest_eigenvalue;
use super::parallel::for_each_chunk_pair;
use super::{Field, GHOST, Grid, Location, Real, Velocity};

/// Coefficient of the fourth difference in the third-order upwind scheme: `|u|/12`.
const FULL_DAMPING: f64 = 1.0 / 12.0;
/// Planes per task; each task recomputes the fluxes into its first plane.
const TASK_PLANES: usize = 8;
/// Values per line, at least a row: a line and its fluxes fit into the first-level cache.
const LINE: usize = 512;

/// Weight of the stage's Euler step in the result of each stage; the rest is the value at the start of the step (Shu & Osher).
pub const STAGES: [f64; 3] = [1.0, 1.0 / 4.0, 2.0 / 3.0];
/// Time at the end of each stage, as a fraction of the step.
pub const STAGE_ENDS: [f64; 3] = [1.0, 0.5, 1.0];

/// Extent of the stability region of the Runge–Kutta scheme along the imaginary axis (pure advection, √3) and along the negative real one (pure diffusion).
pub const REACH: [f64; 2] = [1.732_050_807_568_877_2, 2.512_745_326_618_329];

/// Longest stable step (s) of transport at the given maximum speeds (m/s) along the axes and diffusivity (m²/s).
///
/// Central differences have eigenvalues up to `i·Σ|u|/h`, diffusion up to `−4ν·Σ1/h²`, with somewhat more than 4 across walls
/// ([`diffuse::stable_dt_secs`](super::diffuse::stable_dt_secs)); the straight line between the two extents bounds both together. Upwind damping moves eigenvalues into the part of the stability region beyond this line.
pub fn stable_dt_secs<R: Real>(grid: &Grid<R>, speeds_m_per_s: [f64; 3], diffusivity_m2_per_s: f64) -> f64 {
    let spacing = grid.spacing_m.map(R::wide);
    let advective: f64 = (0..3).map(|axis| speeds_m_per_s[axis] / spacing[axis]).sum();
    let diffusive: f64 = (0..3).map(|axis| largest_eigenvalue(grid, axis) * diffusivity_m2_per_s / (spacing[axis] * spacing[axis])).sum();
    (advective / REACH[0] + diffusive / REACH[1]).recip()
}

/// Work arrays of transport.
#[derive(Clone, Debug)]
pub struct TransportScratch<R> {
    fluxes: Vec<R>,
    per_task: usize,
}

impl<R: Real> TransportScratch<R> {
    /// Allocates the fluxes of every task on `grid`.
    pub fn new(grid: &Grid<R>) -> Self {
        let [_, row, plane] = grid.strides();
        // Fluxes along z through the bottom of a plane, and of one line: through its top, along y and along x.
        let line = LINE.max(row) + row;
        let per_task = plane + 3 * line + 1;
        let tasks = (grid.cells[2] + 1).div_ceil(TASK_PLANES);
        Self { fluxes: vec![R::zero(); per_task * tasks], per_task }
    }

    /// Number of values in the work arrays.
    pub(super) fn values(&self) -> usize {
        self.fluxes.len()
    }
}

/// One stage of a Runge–Kutta step of one field.
#[derive(Clone, Copy)]
pub struct Stage<'a, R> {
    /// The grid.
    pub grid: &'a Grid<R>,
    /// Advecting velocity, with ghosts.
    pub air: &'a Velocity<R>,
    /// Advected field, with ghosts: a velocity component or a concentration.
    pub carried: &'a Field<R>,
    /// The same at the start of the step.
    pub start: &'a Field<R>,
    /// Pressure gradient (m/s²) to subtract, if any.
    pub pressure_gradient: Option<&'a Field<R>>,
    /// The step (s).
    pub dt_secs: f64,
    /// Weight of this stage's Euler step; see [`STAGES`].
    pub fraction: f64,
    /// Diffusivity (m²/s) included in the fluxes; 0 for none.
    pub diffusivity_m2_per_s: f64,
    /// Upwind damping relative to that of the third-order upwind scheme, 0 to 1. 0 conserves kinetic energy.
    pub damping: f64,
}

impl<R: Real> Stage<'_, R> {
    /// Writes the interior values of the stage into `target`.
    pub fn run(&self, target: &mut Field<R>, scratch: &mut TransportScratch<R>) {
        let numbers = Numbers::new(self);
        let plane = self.grid.strides()[2];
        let planes = self.grid.free(self.carried.location, 2);
        let inner = &mut target.data[plane * (planes.start + GHOST)..plane * (planes.end + GHOST)];
        for_each_chunk_pair(inner, TASK_PLANES * plane, &mut scratch.fluxes, scratch.per_task, |task, chunk, fluxes| {
            let from = planes.start + TASK_PLANES * task;
            match self.carried.location {
                Location::Centre => advance::<R, true>(self, &numbers, from, chunk, fluxes),
                Location::Face(_) => advance::<R, false>(self, &numbers, from, chunk, fluxes),
            }
        });
    }
}

/// Coefficients of a stage in the precision of the fields.
struct Numbers<R> {
    per_m: [R; 3],
    diffusion: [R; 3],
    damping: R,
    dt: R,
    fraction: R,
}

impl<R: Real> Numbers<R> {
    fn new(stage: &Stage<'_, R>) -> Self {
        let per_m = stage.grid.spacing_m.map(R::recip);
        Self {
            per_m,
            diffusion: per_m.map(|per_m| R::of(stage.diffusivity_m2_per_s) * per_m),
            damping: R::of(FULL_DAMPING * stage.damping),
            dt: R::of(stage.dt_secs),
            fraction: R::of(stage.fraction),
        }
    }
}

/// Advances some planes, starting with number `from`.
#[multiversion(targets("x86_64+avx2"))]
fn advance<R: Real, const LIMITED: bool>(stage: &Stage<'_, R>, numbers: &Numbers<R>, from: usize, planes: &mut [R], scratch: &mut [R]) {
    let (grid, location) = (stage.grid, stage.carried.location);
    let strides = grid.strides();
    let [xs, ys] = [0, 1].map(|axis| grid.free(location, axis));
    if xs.is_empty() || ys.is_empty() {
        return;
    }
    let [_, row, plane] = strides;
    let rows_per_line = (LINE / row).max(1);
    let most = rows_per_line * row;
    let (below, scratch) = scratch.split_at_mut(plane);
    let (above, scratch) = scratch.split_at_mut(most);
    let (along_x, along_y) = scratch.split_at_mut(most + 1);
    let lines = || ys.clone().step_by(rows_per_line).map(|j| (j, (rows_per_line.min(ys.end - j) - 1) * row + xs.len()));

    for (j, n) in lines() {
        flux::<R, LIMITED>(stage, numbers, 2, grid.at([xs.start, j, from]), &mut below[(j - ys.start) * row..][..n]);
    }
    for (number, out) in planes.chunks_mut(plane).enumerate() {
        let k = from + number;
        for (j, n) in lines() {
            let at = grid.at([xs.start, j, k]);
            let (along_x, along_y, above) = (&mut along_x[..n + 1], &mut along_y[..n + row], &mut above[..n]);
            flux::<R, LIMITED>(stage, numbers, 0, at, along_x);
            flux::<R, LIMITED>(stage, numbers, 1, at, along_y);
            flux::<R, LIMITED>(stage, numbers, 2, at + plane, above);
            let below = &mut below[(j - ys.start) * row..][..n];
            let out = &mut out[at - plane * (k + GHOST)..][..n];
            let [here, start] = [stage.carried, stage.start].map(|field| &field.data[at..][..n]);
            let [px, py, pz] = numbers.per_m;
            // As an increment on the start value: a mean weighted by rounded thirds would let the field grow by 3e-8 per step.
            let toward = |start: R, end: R| start + numbers.fraction * (end - start);
            let (west, east) = (&along_x[..n], &along_x[1..]);
            let (south, north) = (&along_y[..n], &along_y[row..]);
            let euler = |i: usize| {
                let net = (east[i] - west[i]) * px + (north[i] - south[i]) * py + (above[i] - below[i]) * pz;
                here[i] - numbers.dt * net
            };
            match stage.pressure_gradient {
                Some(pressure_gradient) => {
                    let pressure_gradient = &pressure_gradient.data[at..][..n];
                    (0..n).for_each(|i| out[i] = toward(start[i], euler(i) - numbers.dt * pressure_gradient[i]));
                }
                None => (0..n).for_each(|i| out[i] = toward(start[i], euler(i))),
            }
            below.copy_from_slice(above);
        }
    }
}

/// Fluxes through the lower faces, across `axis`, of the values in memory from `at` on.
#[inline(always)]
fn flux<R: Real, const LIMITED: bool>(stage: &Stage<'_, R>, numbers: &Numbers<R>, axis: usize, at: usize, out: &mut [R]) {
    let strides = stage.grid.strides();
    let (n, s) = (out.len(), strides[axis]);
    let q = &stage.carried.data;
    let [before, low, high, after] = [at - 2 * s, at - s, at, at + s].map(|at| &q[at..][..n]);
    let air = &stage.air.0[axis].data;
    let half = R::of(0.5);
    let diffusion = numbers.diffusion[axis];
    if LIMITED {
        let speed = &air[at..][..n];
        for i in 0..n {
            let (step, blows) = (high[i] - low[i], speed[i] > R::zero());
            let slope = monotonised(step, if blows { low[i] - before[i] } else { after[i] - high[i] });
            let upwind = if blows { low[i] + half * slope } else { high[i] - half * slope };
            out[i] = speed[i] * upwind - diffusion * step;
        }
    } else {
        // The speed through a face of a component's cell is the mean of two values: of this component itself along its own axis.
        let Location::Face(component) = stage.carried.location else { return };
        let [one, other] = [at - strides[component], at].map(|at| &air[at..][..n]);
        for i in 0..n {
            let speed = half * (one[i] + other[i]);
            let step = high[i] - low[i];
            let third = (after[i] - before[i]) - (step + step + step);
            out[i] = half * speed * (low[i] + high[i]) + numbers.damping * speed.abs() * third - diffusion * step;
        }
    }
}

/// The monotonised central limiter of two neighbouring differences: their mean, at most twice either, 0 at extrema.
#[inline(always)]
fn monotonised<R: Real>(a: R, b: R) -> R {
    let two = R::of(2.0);
    let smaller = |a: R, b: R| if a < b { a } else { b };
    let size = smaller(R::of(0.5) * (a + b).abs(), two * smaller(a.abs(), b.abs()));
    let same_sign = a * b > R::zero();
    if same_sign { if a > R::zero() { size } else { -size } } else { R::zero() }
}
