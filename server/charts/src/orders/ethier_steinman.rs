//! Orders on the flow of Ethier & Steinman.

use prairie_wind::Advection::{Bfecc, Conservative, MacCormack, SemiLagrangian};
use prairie_wind::Diffusion::{CrankNicolson, Explicit};
use prairie_wind::TimeScheme::{Reflection, RungeKutta3, Split};
use prairie_wind::{Advection, Boundary, Config, Diffusion, Solver, TimeScheme};

use super::Order;
use crate::air::{run, still_air, velocity_error};
use crate::problems::EthierSteinman;

const NAME: &str = "Ethier–Steinman";
/// The flow in a box whose side is divisible by all tested numbers of cells without rounding.
const PROBLEM: EthierSteinman = EthierSteinman { side_m: 48.0, speed_m_per_s: 1.0, viscosity_m2_per_s: 2.0 };
/// Half the time in which the reference speed crosses the box. Viscosity takes a fifth of the velocity in it.
const SECS: f64 = 24.0;
/// Courant number of the problem's reference speed. The air is up to 3.5 times as fast.
const COURANT: f64 = 0.2;

/// A method, with its formal order, and the one to expect on these grids if that differs.
struct Trial {
    advection: Advection,
    time: TimeScheme,
    diffusion: Diffusion,
    formal: f64,
    pinned: Option<f64>,
}

/// The default.
const DEFAULT: Trial = Trial { advection: Conservative, time: RungeKutta3, diffusion: Explicit, formal: 2.0, pinned: None };

const TRIALS: [Trial; 5] = [
    DEFAULT,
    Trial { diffusion: CrankNicolson, ..DEFAULT },
    Trial { advection: MacCormack, time: Reflection, pinned: Some(2.2), ..DEFAULT },
    Trial { advection: Bfecc, time: Reflection, pinned: Some(2.2), ..DEFAULT },
    Trial { advection: SemiLagrangian, time: Split, formal: 1.0, pinned: Some(0.8), ..DEFAULT },
];

fn error_l2(trial: &Trial, cells: usize) -> f64 {
    let spacing_m = PROBLEM.side_m / cells as f64;
    let config = Config {
        advection: trial.advection,
        time: trial.time,
        diffusion: trial.diffusion,
        viscosity_m2_per_s: PROBLEM.viscosity_m2_per_s as f32,
        ..still_air([cells; 3], [spacing_m; 3], [[Boundary::Inflow; 2]; 3])
    };
    let mut air = Solver::<f64>::new(&config).expect("settings are allowed");
    air.set_inflow(|position, time_secs| PROBLEM.velocity(position, time_secs));
    air.set_velocity(|position| PROBLEM.velocity(position, 0.0));
    run(&mut air, SECS, (SECS * PROBLEM.speed_m_per_s / (COURANT * spacing_m)).round() as usize);
    velocity_error(&air, |position| PROBLEM.velocity(position, SECS)).l2
}

fn fit(trial: &Trial, cells: [usize; 3]) -> Order {
    let errors = cells.map(|n| (PROBLEM.side_m / n as f64, error_l2(trial, n))).to_vec();
    let Trial { advection, time, diffusion, formal, pinned } = trial;
    Order::fit(NAME, format!("{advection:?} {time:?} {diffusion:?}"), "dt ∝ h, L2", *formal, errors).pinned_to(*pinned)
}

/// Every method in a box with the velocity prescribed on all six faces, time step in proportion to the spacing; takes minutes.
pub fn beltrami() -> Vec<Order> {
    TRIALS.iter().map(|trial| fit(trial, [16, 32, 64])).collect()
}

/// The default, with explicit friction and Crank–Nicolson, on the two coarser grids of [`beltrami`] and one between them.
pub fn coarse_beltrami() -> Vec<Order> {
    TRIALS[..2].iter().map(|trial| fit(trial, [16, 24, 32])).collect()
}
