//! Measures the times of the wind's methods on this machine.

use super::bend_pilot::ns_per_cell_step;
use super::blade_pilot::ns_per_step;
use super::fronts::{Fronts, bend_row, blade_row, diffusion_row, pressure_row};
use super::settings::TOLERANCES;
use prairie_core::bend::Scheme;
use prairie_core::scene::{BladeIntegrator, WindDiffusion, WindPressure};
use prairie_wind::pressure::{Effort, IterativeMethod};
use prairie_wind::{Advection, Air, Boundary, Canopy, Config, Diffusion, Dust, Method, Pressure, TimeScheme};
use std::time::Instant;

/// Cells along X and Z of the measured boxes, which are eight cells high.
const SIDES: [usize; 5] = [8, 16, 32, 64, 128];
/// Duration of a step (s).
const STEP_SECS: f64 = 0.05;
/// Measured batches of steps, of which the fastest counts, and least duration of a batch (s).
const BATCHES: usize = 5;
const BATCH_SECS: f64 = 0.01;

/// A method to time: its row, its settings, and the row that is subtracted.
struct Row {
    name: String,
    method: Method,
    config: Config,
    base: Option<String>,
    has_walls: bool,
}

/// Times every method in every box; `show` is told how many of how many measurements are done.
pub fn calibrate(mut show: impl FnMut(usize, usize)) -> Fronts {
    let mut fronts = Fronts::here();
    let (rows, mut done) = (rows(), 0);
    for side in SIDES {
        fronts.cells.push((8 * side * side) as f64);
        for row in &rows {
            let ns = time_ns(row, side);
            let base = row.base.as_ref().and_then(|base| fronts.ns[base].last().copied()).unwrap_or(0.0);
            // Differences are rounded like times: more digits are not repeatable.
            fronts.ns.entry(row.name.clone()).or_default().push(((ns - base) * 10.0).round() / 10.0);
            done += 1;
            show(done, SIDES.len() * rows.len());
        }
    }
    for scheme in [Scheme::Substepped, Scheme::Implicit, Scheme::Verlet] {
        let ns = (ns_per_cell_step(scheme) * 100.0).round() / 100.0;
        fronts.ns.insert(bend_row(scheme), vec![ns; SIDES.len()]);
    }
    for &integrator in BladeIntegrator::ALL {
        let ns = (ns_per_step(integrator) * 10.0).round() / 10.0;
        fronts.ns.insert(blade_row(integrator), vec![ns; SIDES.len()]);
    }
    fronts
}

fn step_row(advection: Advection, time: TimeScheme) -> String {
    format!("step/{}/{}", advection.name(), time.name())
}

/// All methods, each after the one that is subtracted from it.
fn rows() -> Vec<Row> {
    let base = Config {
        boundary: [[Boundary::Wrap; 2], [Boundary::FreeSlip; 2], [Boundary::Wrap; 2]],
        canopy: Some(Canopy::default()),
        ..Config::default()
    };
    let row = |name: String, config: Config, base: Option<String>| Row { name, method: Method::Staggered, config, base, has_walls: false };
    let pairs = Advection::ALL.iter().flat_map(|advection| TimeScheme::ALL.iter().map(move |time| (*advection, *time)));
    let mut rows: Vec<_> = pairs
        .filter(|(advection, time)| time.allows(*advection))
        .map(|(advection, time)| row(step_row(advection, time), Config { advection, time, ..base.clone() }, None))
        .collect();
    let zhang = Config {
        advection: Advection::SemiLagrangian,
        time: TimeScheme::Split,
        diffusion: Diffusion::GaussSeidel { sweeps: 20 },
        pressure: Pressure::Iterative(IterativeMethod::GaussSeidel, Effort { tolerance: 1e-5, sweeps: 20 }),
        canopy: None,
        ..base.clone()
    };
    rows.push(Row { method: Method::StableFluids, ..row("step/stable-fluids".to_owned(), zhang, None) });
    let own = Some(step_row(Advection::Conservative, TimeScheme::RungeKutta3));
    let diffusions = [
        (WindDiffusion::GaussSeidel, Diffusion::GaussSeidel { sweeps: 20 }),
        (WindDiffusion::Implicit, Diffusion::Implicit),
        (WindDiffusion::CrankNicolson, Diffusion::CrankNicolson),
    ];
    rows.extend(diffusions.map(|(word, diffusion)| row(diffusion_row(word), Config { diffusion, ..base.clone() }, own.clone())));
    let solvers = [
        (WindPressure::Sor, IterativeMethod::Sor),
        (WindPressure::ConjugateGradients, IterativeMethod::ConjugateGradients),
        (WindPressure::Multigrid, IterativeMethod::Multigrid),
    ];
    for (word, iteration) in solvers {
        rows.extend(TOLERANCES.map(|tolerance| {
            let pressure = Pressure::Iterative(iteration, Effort { tolerance: tolerance.into(), sweeps: 200 });
            row(pressure_row(word, tolerance), Config { pressure, ..base.clone() }, own.clone())
        }));
    }
    rows.push(row("dust".to_owned(), Config { dust: Some(Dust::default()), ..base.clone() }, own.clone()));
    rows.push(Row { has_walls: true, ..row("walls".to_owned(), base, own) });
    rows
}

/// Shortest time of a step, per cell (ns).
fn time_ns(row: &Row, side: usize) -> f64 {
    let config = Config { cells: [side, 8, side], ..row.config.clone() };
    let mut air = Air::<f32>::new(row.method, &config).expect("valid settings");
    if row.has_walls {
        let middle_m = 4.0 * side as f64;
        air.set_walls(|[x, y, z]| y - (6.0 - 0.1 * (x - middle_m).hypot(z - middle_m)), |_| [0.0; 3]).expect("walls for the direct solver");
    }
    let mut step = || air.step(STEP_SECS, &[]).map_or(1, |report| report.substeps);
    step();
    let mut best_ns = f64::INFINITY;
    for _ in 0..BATCHES {
        let (start, mut steps) = (Instant::now(), 0);
        while start.elapsed().as_secs_f64() < BATCH_SECS || steps == 0 {
            steps += step();
        }
        best_ns = best_ns.min(start.elapsed().as_secs_f64() * 1e9 / f64::from(steps));
    }
    best_ns / (8 * side * side) as f64
}
