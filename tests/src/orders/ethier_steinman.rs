//! Orders on the flow of Ethier & Steinman.

use prairie_wind::Advection::{Bfecc, Conservative, MacCormack, SemiLagrangian};
use prairie_wind::TimeScheme::{Reflection, RungeKutta3, Split};
use prairie_wind::{Advection, Boundary, Config, Solver, TimeScheme};

use super::Order;
use crate::air::{run, still_air, velocity_error};
use crate::problems::EthierSteinman;

const NAME: &str = "Ethier–Steinman";
const SECS: f64 = 6.0;
/// Courant number of the problem's reference speed. The air is up to 3.5 times as fast.
const COURANT: f64 = 0.1;

/// A scheme, its formal order, and its test parameters.
struct Trial {
    advection: Advection,
    time: TimeScheme,
    formal: f64,
    viscosity_m2_per_s: f64,
    cells: &'static [usize],
}

/// The flow in a box whose side is divisible by all tested numbers of cells without rounding.
fn flow(viscosity_m2_per_s: f64) -> EthierSteinman {
    EthierSteinman { side_m: 48.0, speed_m_per_s: 1.0, viscosity_m2_per_s }
}

fn error_l2(trial: &Trial, cells: usize) -> f64 {
    let problem = flow(trial.viscosity_m2_per_s);
    let spacing_m = problem.side_m / cells as f64;
    let config = Config {
        advection: trial.advection,
        time: trial.time,
        viscosity_m2_per_s: problem.viscosity_m2_per_s as f32,
        ..still_air([cells; 3], [spacing_m; 3], [[Boundary::Inflow; 2]; 3])
    };
    let mut air = Solver::<f64>::new(&config).expect("settings are allowed");
    air.set_inflow(move |position, time_secs| problem.velocity(position, time_secs));
    air.set_velocity(|position| problem.velocity(position, 0.0));
    run(&mut air, SECS, (SECS * problem.speed_m_per_s / (COURANT * spacing_m)).round() as usize);
    velocity_error(&air, |position| problem.velocity(position, SECS)).l2
}

/// Each scheme in a box with the velocity prescribed on all six faces, time step in proportion to the spacing.
///
/// The numerical viscosity of semi-Lagrangian advection, `|u|·h/2`, must be small compared with the flow's own for the order to show: this needs a high
/// viscosity and fine grids.
pub fn beltrami() -> Vec<Order> {
    let trial = |advection, time, formal, viscosity_m2_per_s, cells| Trial { advection, time, formal, viscosity_m2_per_s, cells };
    let trials = [
        trial(Conservative, RungeKutta3, 2.0, 1.0, &[8, 12, 16, 24, 32][..]),
        trial(MacCormack, Reflection, 2.0, 2.0, &[24, 32, 48]),
        trial(Bfecc, Reflection, 2.0, 2.0, &[24, 32, 48]),
        trial(SemiLagrangian, Split, 1.0, 16.0, &[32, 48, 64]),
    ];
    let row = |trial: Trial| {
        let errors = trial.cells.iter().map(|&n| (48.0 / n as f64, error_l2(&trial, n))).collect();
        Order::fit(NAME, format!("{:?} {:?}", trial.advection, trial.time), "dt ∝ h, L2", trial.formal, errors)
    };
    trials.map(row).into()
}
