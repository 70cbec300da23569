//! Flows with exact solutions.

use prairie_wind::{Air, Boundary, Config, Method, Solver};

use super::super::{Outcome, Problem, Run};
use super::{COURANT, Choice, METHODS, Steps};
use crate::air::{still_air, velocity_error};
use crate::norms::Norms;
use crate::problems::{EthierSteinman, TaylorGreen};

const VORTEX: TaylorGreen = TaylorGreen { side_m: 10.0, speed_m_per_s: 1.0, drift_m_per_s: [0.5, 0.25], viscosity_m2_per_s: 0.05 };
/// Largest speed along an axis (m/s), at the start.
const VORTEX_FASTEST_M_PER_S: f64 = 1.5;
const BELTRAMI: EthierSteinman = EthierSteinman { side_m: 2.0, speed_m_per_s: 1.0, viscosity_m2_per_s: 0.05 };
const BELTRAMI_FASTEST_M_PER_S: f64 = 3.5;

/// A drifting vortex in a periodic box, over 2 s; also by Zhang's method.
pub(super) fn taylor_green(cells: &[usize]) -> Problem {
    let staggered = METHODS.map(|choice| (Method::Staggered, choice));
    let as_in_zhang: (Method, Choice) = (Method::StableFluids, ("Zhang", |_| ()));
    let mut runs = Vec::new();
    for (method, (name, choose)) in staggered.into_iter().chain([as_in_zhang]) {
        for courant in COURANT {
            runs.extend(cells.iter().map(|&n| vortex(method, name, choose, n, courant)));
        }
    }
    Problem {
        name: "Taylor–Green",
        error: "rms error of velocity (m/s)",
        per: "simulated second",
        default_method: Some("conservative, damping 1"),
        cell_bytes: 24,
        runs,
    }
}

fn vortex(method: Method, name: &str, choose: fn(&mut Config), n: usize, courant: f64) -> Run {
    let (cells, spacing_m) = ([n, 1, n], VORTEX.side_m / n as f64);
    let viscosity_m2_per_s = VORTEX.viscosity_m2_per_s as f32;
    let mut config = Config { viscosity_m2_per_s, ..still_air(cells, [spacing_m; 3], [[Boundary::Wrap; 2]; 3]) };
    choose(&mut config);
    let steps = Steps::new(2.0, courant * spacing_m / VORTEX_FASTEST_M_PER_S);
    let solve = move || {
        let mut air = Air::<f64>::new(method, &config)?;
        air.set_velocity(|position| VORTEX.velocity(position, 0.0));
        let wall = steps.take(|dt_secs| air.step(dt_secs, &[]))?;
        let exact = |position| VORTEX.velocity(position, steps.simulated_secs());
        let along = |axis: usize| air.samples(axis).map(move |(position, found)| (found, exact(position)[axis]));
        Ok(Outcome { error: Norms::of(along(0).chain(along(2))), simulated_secs: steps.simulated_secs(), wall })
    };
    Run { method: format!("{name}, Courant {courant}"), cells, dt_secs: steps.dt_secs, solve: Box::new(solve) }
}

/// A three-dimensional flow through all faces of a box, over half a second.
pub(super) fn ethier_steinman(cells: &[usize]) -> Problem {
    let mut runs = Vec::new();
    for choice in METHODS {
        for courant in COURANT {
            runs.extend(cells.iter().map(|&n| beltrami(choice, n, courant)));
        }
    }
    Problem {
        name: "Ethier–Steinman",
        error: "rms error of velocity (m/s)",
        per: "simulated second",
        default_method: Some("conservative, damping 1"),
        cell_bytes: 24,
        runs,
    }
}

fn beltrami((name, choose): Choice, n: usize, courant: f64) -> Run {
    let (cells, spacing_m) = ([n; 3], BELTRAMI.side_m / n as f64);
    let viscosity_m2_per_s = BELTRAMI.viscosity_m2_per_s as f32;
    let mut config = Config { viscosity_m2_per_s, ..still_air(cells, [spacing_m; 3], [[Boundary::Inflow; 2]; 3]) };
    choose(&mut config);
    let steps = Steps::new(0.5, courant * spacing_m / BELTRAMI_FASTEST_M_PER_S);
    let solve = move || {
        let mut air = Solver::<f64>::new(&config)?;
        air.set_inflow(|position, time_secs| BELTRAMI.velocity(position, time_secs));
        air.set_velocity(|position| BELTRAMI.velocity(position, 0.0));
        let wall = steps.take(|dt_secs| air.step(dt_secs, &[]))?;
        let error = velocity_error(&air, |position| BELTRAMI.velocity(position, steps.simulated_secs()));
        Ok(Outcome { error, simulated_secs: steps.simulated_secs(), wall })
    };
    Run { method: format!("{name}, Courant {courant}"), cells, dt_secs: steps.dt_secs, solve: Box::new(solve) }
}
