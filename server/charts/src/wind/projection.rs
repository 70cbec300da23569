//! A single projection by each pressure method: time against the remaining divergence.

use std::f64::consts::TAU;
use std::time::Instant;

use anyhow::Result;
use prairie_wind::boundary::BoundaryConditions;
use prairie_wind::pressure::{Effort, IterativeMethod, Projection, divergence};
use prairie_wind::{Boundary, Grid, Pressure, StableFluids, Velocity};

use super::super::{Outcome, Problem, Run};
use crate::air::still_air;
use crate::norms::Norms;

/// Tolerances (relative residual) of the methods that reach them.
const TOLERANCES: [f64; 8] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8];
/// Numbers of sweeps of the slowly converging methods.
const SWEEPS: [u32; 4] = [10, 30, 100, 300];
/// Number of sweeps in Zhang's listings.
const SWEEPS_OF_000: u32 = 20;
/// Iteration limit, more than any method needs.
const MOST_SWEEPS: u32 = 100_000;

const CLOSED: [[Boundary; 2]; 3] = [[Boundary::FreeSlip; 2]; 3];

/// Air with waves of every octave in a closed cube of `n`³ cells, projected once with an initial guess of 0.
pub(super) fn projection(name: &'static str, n: usize) -> Problem {
    let upto = |method| TOLERANCES.map(|tolerance| Pressure::Iterative(method, Effort { tolerance, sweeps: MOST_SWEEPS }));
    let swept = |method| SWEEPS.map(|sweeps| Pressure::Iterative(method, Effort { tolerance: 0.0, sweeps }));
    let mut runs = vec![run("direct", n, move || staggered(n, Pressure::Direct))];
    let methods = [
        ("multigrid", IterativeMethod::Multigrid),
        ("conjugate gradients", IterativeMethod::ConjugateGradients),
        ("red–black SOR", IterativeMethod::Sor),
    ];
    for (name, method) in methods {
        runs.extend(upto(method).map(|pressure| run(name, n, move || staggered(n, pressure))));
    }
    for (name, method) in [("Gauss–Seidel", IterativeMethod::GaussSeidel), ("Jacobi", IterativeMethod::Jacobi)] {
        runs.extend(swept(method).map(|pressure| run(name, n, move || staggered(n, pressure))));
    }
    runs.push(run("Zhang, 20 sweeps", n, move || as_in_zhang(n)));
    Problem {
        name,
        error: "remaining divergence (relative to rms before)",
        per: "projection",
        default_method: Some("direct"),
        cell_bytes: 24,
        runs,
    }
}

fn run(method: &str, n: usize, solve: impl Fn() -> Result<Outcome> + 'static) -> Run {
    Run { method: method.into(), cells: [n; 3], dt_secs: 0.0, solve: Box::new(solve) }
}

/// Velocity (m/s) in a box of unit cells: waves in every octave up to four cells long, slower the shorter they are, by Kolmogorov's k^(−1/3).
fn octaves(n: usize, position: [f64; 3]) -> [f64; 3] {
    let octaves = std::iter::successors(Some(1.0), |k| Some(2.0 * k)).take_while(|k| *k <= n as f64 / 4.0);
    octaves.fold([0.0; 3], |sum, k| {
        let phase = |axis: usize| k * TAU * position[axis] / n as f64 + k;
        std::array::from_fn(|axis| {
            sum[axis] + k.powf(-1.0 / 3.0) * phase(axis).sin() * (phase((axis + 1) % 3) + phase((axis + 2) % 3)).cos()
        })
    })
}

/// Norms of the remaining divergence, relative to the root mean square before.
fn left_over(before: &[f64], after: &[f64]) -> Norms {
    let norms = |divergence: &[f64]| Norms::of(divergence.iter().map(|&d| (d, 0.0)));
    let (rms, left) = (norms(before).l2, norms(after));
    Norms { l1: left.l1 / rms, l2: left.l2 / rms, linf: left.linf / rms }
}

fn staggered(n: usize, pressure: Pressure) -> Result<Outcome> {
    let grid = Grid { cells: [n; 3], spacing_m: [1.0; 3], boundary: CLOSED };
    let walls = BoundaryConditions::new(&grid, Box::new(|_, _| [0.0; 3]));
    let mut given = Velocity::zeros(&grid);
    for (axis, field) in given.0.iter_mut().enumerate() {
        field.fill(&grid, |position| octaves(n, position)[axis]);
    }
    walls.apply(&mut given);
    let mut projection = Projection::new(&grid, pressure, None);
    // A warm-up run, so that all memory has been touched; still air then resets the initial guess to 0.
    let mut air = given.clone();
    projection.project(&grid, &mut air, &[], None);
    projection.project(&grid, &mut Velocity::zeros(&grid), &[], None);

    air.clone_from(&given);
    let start = Instant::now();
    projection.project(&grid, &mut air, &[], None);
    let wall = start.elapsed();
    let [before, after] = [&given, &air].map(|velocity| {
        let mut per_cell = vec![0.0; grid.len()];
        divergence(&grid, velocity, 1.0, &mut per_cell);
        per_cell
    });
    Ok(Outcome { error: left_over(&before, &after), simulated_secs: 1.0, wall })
}

fn as_in_zhang(n: usize) -> Result<Outcome> {
    let mut air = StableFluids::<f64>::new(&still_air([n; 3], [1.0; 3], CLOSED))?;
    air.set_velocity(|position| octaves(n, position));
    air.project(SWEEPS_OF_000);
    air.set_velocity(|position| octaves(n, position));
    let before = central_divergence(&air);
    let start = Instant::now();
    air.project(SWEEPS_OF_000);
    let wall = start.elapsed();
    Ok(Outcome { error: left_over(&before, &central_divergence(&air)), simulated_secs: 1.0, wall })
}

/// Divergence (1/s) of each unit cell by central differences, as in Zhang.
fn central_divergence(air: &StableFluids<f64>) -> Vec<f64> {
    let (grid, velocity) = (air.grid(), air.velocity());
    let strides = grid.strides();
    let along = |at: usize, axis: usize| 0.5 * (velocity.0[axis].data[at + strides[axis]] - velocity.0[axis].data[at - strides[axis]]);
    let cells = velocity.0[0].rows(grid).flat_map(|row| row..row + grid.cells[0]);
    cells.map(|at| (0..3).map(|axis| along(at, axis)).sum()).collect()
}
