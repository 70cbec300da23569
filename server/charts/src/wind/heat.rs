//! The heat kernel, by each diffusion scheme.

use prairie_wind::boundary::BoundaryConditions;
use prairie_wind::diffuse::{Implicit, Portion, diffuse};
use prairie_wind::{Boundary, Diffusion, Field, Grid, Location};

use super::super::{Outcome, Problem, Run};
use super::Steps;
use crate::norms::Norms;
use crate::problems::HeatKernel;

const KERNEL: HeatKernel = HeatKernel { side_m: [Some(8.0), None, Some(8.0)], centre_m: [3.3, 0.0, 4.6], diffusivity_m2_per_s: 0.125 };
const SIDE_M: f64 = 8.0;
/// Start and end of the run (s).
const WATCHED_SECS: [f64; 2] = [2.0, 4.0];
/// Diffusion numbers `a = κ·dt/h²`, the same on all grids: the errors in time and space then shrink together. The explicit limit is 1/6.
const NUMBERS: [f64; 2] = [0.1, 2.0];

/// A scheme, and its number of sub-steps.
type Scheme = (&'static str, Diffusion, &'static [Portion]);

const SCHEMES: [Scheme; 5] = [
    ("explicit Euler", Diffusion::Explicit, &[Portion::Whole]),
    ("explicit midpoint", Diffusion::Explicit, &[Portion::First, Portion::Second]),
    ("Gauss–Seidel, 20 sweeps", Diffusion::GaussSeidel { sweeps: 20 }, &[Portion::Whole]),
    ("implicit Euler", Diffusion::Implicit, &[Portion::Whole]),
    ("Crank–Nicolson", Diffusion::CrankNicolson, &[Portion::Whole]),
];

/// Heat that spreads in a periodic square for two seconds. Explicit steps beyond the stability limit are subdivided.
pub(super) fn heat_kernel(cells: &[usize]) -> Problem {
    let mut runs = Vec::new();
    for scheme in SCHEMES {
        for number in NUMBERS {
            runs.extend(cells.iter().map(|&n| run(scheme, n, number)));
        }
    }
    Problem {
        name: "Heat kernel",
        error: "rms error of density (1/m²)",
        per: "simulated second",
        default_method: Some("explicit Euler"),
        cell_bytes: 8,
        runs,
    }
}

fn run((name, diffusion, portions): Scheme, n: usize, number: f64) -> Run {
    let spacing_m = SIDE_M / n as f64;
    let grid = Grid { cells: [n, 1, n], spacing_m: [spacing_m; 3], boundary: [[Boundary::Wrap; 2]; 3] };
    let [from, to] = WATCHED_SECS;
    let diffusivity = KERNEL.diffusivity_m2_per_s;
    let steps = Steps::new(to - from, number * spacing_m * spacing_m / diffusivity);
    let solve = move || {
        let walls = BoundaryConditions::new(&grid, Box::new(|_, _| [0.0; 3]));
        let close = |field: &mut Field<f64>| walls.apply_to_concentration(field);
        let [mut heat, mut even, mut odd] = [0; 3].map(|_| Field::zeros(&grid, Location::Centre));
        let mut implicit = Implicit::new(&grid);
        heat.fill(&grid, |position| KERNEL.density(position, from));
        close(&mut heat);
        let wall = steps.take(|dt_secs| {
            for &portion in portions {
                diffuse(
                    diffusion,
                    portion,
                    &grid,
                    diffusivity,
                    dt_secs,
                    &mut heat,
                    [&mut even, &mut odd],
                    Some(&mut implicit),
                    |field, _| close(field),
                );
            }
            Ok(())
        })?;
        let error = Norms::of(heat.samples(&grid).map(|(position, found)| (found, KERNEL.density(position, to))));
        Ok(Outcome { error, simulated_secs: steps.simulated_secs(), wall })
    };
    Run { method: format!("{name}, a = {number}"), cells: grid.cells, dt_secs: steps.dt_secs, solve: Box::new(solve) }
}
