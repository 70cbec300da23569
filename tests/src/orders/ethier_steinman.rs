//! Orders on the flow of Ethier & Steinman.

use server::wind::Advection::{Bfecc, Conservative, MacCormack, SemiLagrangian};
use server::wind::TimeScheme::{Reflection, RungeKutta3, Split};
use server::wind::{Advection, Boundary, Config, Solver, TimeScheme};

use super::Order;
use crate::air::{run, still_air, velocity_error};
use crate::norms::Norms;
use crate::problems::EthierSteinman;

/// The flow at a viscosity at which advection and friction both matter. Its side is one that 8, 12, 16, 24 and 32 cells divide without rounding.
pub const PROBLEM: EthierSteinman = EthierSteinman { side_m: 48.0, speed_m_per_s: 1.0, viscosity_m2_per_s: 2.0 };
const NAME: &str = "Ethier–Steinman";
const SECS: f64 = 6.0;

/// Schemes tried, and their formal orders.
pub const SCHEMES: [(Advection, TimeScheme, f64); 4] =
    [(Conservative, RungeKutta3, 2.0), (SemiLagrangian, Split, 1.0), (MacCormack, Reflection, 2.0), (Bfecc, Reflection, 2.0)];

/// Error (m/s) of one scheme at the end on a cube of so many cells along an axis, in steps of `courant` of a spacing over the speed of the problem.
pub fn error(advection: Advection, time: TimeScheme, cells: usize, courant: f64) -> Norms {
    let spacing_m = PROBLEM.side_m / cells as f64;
    let config = Config {
        advection,
        time,
        viscosity_m2_per_s: PROBLEM.viscosity_m2_per_s as f32,
        ..still_air([cells; 3], [spacing_m; 3], [[Boundary::Inflow; 2]; 3])
    };
    let mut air = Solver::<f64>::new(&config).expect("settings are allowed");
    air.prescribe(|position, time_secs| PROBLEM.velocity(position, time_secs));
    air.set_velocity(|position| PROBLEM.velocity(position, 0.0));
    run(&mut air, SECS, (SECS * PROBLEM.speed_m_per_s / (courant * spacing_m)).round() as usize);
    velocity_error(&air, |position| PROBLEM.velocity(position, SECS))
}

/// Each scheme, time step in proportion to the spacing.
pub fn beltrami(courant: f64, cells: &[usize]) -> Vec<Order> {
    let row = |(advection, time, formal)| {
        let errors = cells.iter().map(|&n| (PROBLEM.side_m / n as f64, error(advection, time, n, courant).l2));
        Order::fit(NAME, format!("{advection:?} {time:?}"), "dt ∝ h, L2", formal, errors.collect())
    };
    SCHEMES.map(row).to_vec()
}
