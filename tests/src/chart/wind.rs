//! The runs of the wind: methods on problems with known answers, from coarse to fine.

use std::time::{Duration, Instant};

use anyhow::Result;
use server::wind::{Advection, Boundary, Config, Gusts, Profile, Solver};

use super::{Outcome, Run};
use crate::norms::Norms;
use crate::problems::TaylorGreen;

/// A method by name, and how it differs from the default settings.
type Method = (&'static str, fn(&mut Config));

const METHODS: [Method; 2] = [
    ("semi-Lagrangian", |config| config.advection = Advection::SemiLagrangian),
    ("MacCormack", |config| config.advection = Advection::MacCormack),
];

/// Courant numbers, of the largest speed at the start, that each method is tried at.
const COURANT: [f64; 2] = [0.5, 2.0];

/// All runs; `quick` leaves out the finest.
pub fn runs(quick: bool) -> Vec<Run> {
    let cells: &[usize] = if quick { &[16, 32, 64] } else { &[16, 32, 64, 128, 256] };
    let mut runs = Vec::new();
    for method in METHODS {
        for courant in COURANT {
            runs.extend(cells.iter().map(|&cells| taylor_green(method, cells, courant)));
        }
    }
    runs
}

/// A drifting vortex in a box that wraps, over 2 s.
fn taylor_green((name, choose): Method, cells: usize, courant: f64) -> Run {
    const PROBLEM: TaylorGreen = TaylorGreen { side_m: 10.0, speed_m_per_s: 1.0, drift_m_per_s: [0.5, 0.25], viscosity_m2_per_s: 0.05 };
    const SIMULATED_SECS: f64 = 2.0;
    let spacing_m = PROBLEM.side_m / cells as f64;
    let fastest = PROBLEM.speed_m_per_s + PROBLEM.drift_m_per_s[0];
    let steps = (SIMULATED_SECS * fastest / (courant * spacing_m)).ceil();
    let dt_secs = SIMULATED_SECS / steps;
    let mut config = Config {
        cells: [cells, 1, cells],
        spacing_m: [spacing_m as f32, 1.0, spacing_m as f32],
        boundary: [Boundary::Wrap; 3],
        viscosity_m2_per_s: PROBLEM.viscosity_m2_per_s as f32,
        mean_wind_m_per_s: [PROBLEM.drift_m_per_s[0] as f32, 0.0, PROBLEM.drift_m_per_s[1] as f32],
        profile: Profile::Uniform,
        gusts: Gusts { number: 0, ..Gusts::default() },
        ..Config::default()
    };
    choose(&mut config);
    let solve = move || {
        let mut wind = Solver::<f64>::new(&config)?;
        wind.set_velocity(|position| PROBLEM.velocity(position, 0.0));
        let wall = step_through(&mut wind, steps as usize, dt_secs)?;
        let error = velocity_error(&wind, |position| PROBLEM.velocity(position, wind.time_secs()));
        Ok(Outcome { error, simulated_secs: wind.time_secs(), wall })
    };
    Run {
        problem: "Taylor–Green", method: format!("{name}, Courant {courant}"), cells: [cells, 1, cells], dt_secs, solve: Box::new(solve)
    }
}

/// Takes steps, and says how long they took.
fn step_through(wind: &mut Solver<f64>, steps: usize, dt_secs: f64) -> Result<Duration> {
    let start = Instant::now();
    for _ in 0..steps {
        wind.step(dt_secs as f32, &[])?;
    }
    Ok(start.elapsed())
}

/// Error (m/s) of the components on their faces; along an axis of one cell nothing moves, and nothing is counted.
fn velocity_error(wind: &Solver<f64>, exact: impl Fn([f64; 3]) -> [f64; 3]) -> Norms {
    let (grid, exact) = (wind.grid(), &exact);
    let moving = wind.velocity().0.iter().enumerate().filter(|(axis, _)| grid.cells[*axis] > 1);
    let pairs = moving.flat_map(|(axis, field)| {
        let [nx, ny, _] = field.shape;
        let at = move |n: usize| grid.position_m(field.place, [n % nx, n / nx % ny, n / (nx * ny)]);
        field.data.iter().enumerate().map(move |(n, &found)| (found, exact(at(n))[axis]))
    });
    Norms::of(pairs)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_run_is_named_once_and_a_coarse_one_gets_near_the_answer() {
        let runs = runs(true);
        let names: std::collections::HashSet<_> = runs.iter().map(|run| (run.problem, run.method.clone(), run.cells)).collect();
        assert_eq!(names.len(), runs.len());
        let outcome = (runs[0].solve)().unwrap();
        assert!((outcome.simulated_secs - 2.0).abs() < 1e-5, "{outcome:?}");
        assert!(outcome.error.l2 > 0.0 && outcome.error.l2 < 0.5, "{outcome:?}");
    }
}
