//! Orders on the decaying Taylor–Green vortex.

use prairie_wind::TimeScheme::{RungeKutta3, Split};
use prairie_wind::{Advection, Boundary, Config, Diffusion, Solver, TimeScheme};

use super::Order;
use crate::air::{run, still_air, velocity_difference, velocity_error};
use crate::norms::Norms;
use crate::problems::TaylorGreen;

/// The side is divisible by all tested numbers of cells without rounding.
const PROBLEM: TaylorGreen = TaylorGreen { side_m: 48.0, speed_m_per_s: 1.0, drift_m_per_s: [0.5, 0.25], viscosity_m2_per_s: 0.1875 };
/// A viscosity (m²/s) large enough for the time error of diffusion to show.
const THICK_M2_PER_S: f64 = 3.0;
const NAME: &str = "Taylor–Green";
const SECS: f64 = 6.0;
/// Largest sum of the speeds along both axes (m/s).
const FASTEST_M_PER_S: f64 = 1.75;

/// Every allowed pair of advection and time scheme, with its formal order.
fn schemes() -> impl Iterator<Item = (Advection, TimeScheme, u32)> {
    let pairs = TimeScheme::ALL.iter().flat_map(|&time| Advection::ALL.iter().map(move |&advection| (advection, time)));
    pairs
        .filter(|&(advection, time)| time.allows(advection))
        .map(|(advection, time)| (advection, time, advection.order().min(time.order())))
}

fn config(cells: usize) -> Config {
    let spacing_m = PROBLEM.side_m / cells as f64;
    Config {
        viscosity_m2_per_s: PROBLEM.viscosity_m2_per_s as f32,
        ..still_air([cells, 1, cells], [spacing_m; 3], [[Boundary::Wrap; 2]; 3])
    }
}

fn vortex(config: &Config, steps: usize) -> Solver<f64> {
    let mut air = Solver::new(config).expect("settings are allowed");
    air.set_velocity(|position| PROBLEM.velocity(position, 0.0));
    run(&mut air, SECS, steps);
    air
}

/// Number of steps at a Courant number.
fn steps(cells: usize, courant: f64) -> usize {
    (SECS * FASTEST_M_PER_S * cells as f64 / (PROBLEM.side_m * courant)).round() as usize
}

fn error_at_end(config: &Config, steps: usize) -> Norms {
    velocity_error(&vortex(config, steps), |position| PROBLEM.velocity(position, SECS))
}

/// Every advection with every time scheme, time step in proportion to the spacing, at a Courant number of 0.25.
///
/// The error of the semi-Lagrangian family mixes powers of the spacing and the time step, `h²/dt` among them, so it has an order only along such a line.
/// MacCormack and BFECC fall back to first order next to extrema, over a part of the box that shrinks with the spacing: their orders approach 2 from above.
pub fn advection_and_time() -> Vec<Order> {
    Advection::ALL.iter().flat_map(|&advection| times_of(advection)).collect()
}

/// The rows of [`advection_and_time`] with one advection.
pub fn times_of(advection: Advection) -> Vec<Order> {
    let mut rows = Vec::new();
    for (_, time, formal) in schemes().filter(|scheme| scheme.0 == advection) {
        // Its fallback next to extrema ends between these grids.
        let pinned = (advection == Advection::Bfecc && time == TimeScheme::Reflection).then_some(2.2);
        let dampings: &[f32] = if advection.uses_fluxes() { &[1.0, 0.0] } else { &[1.0] };
        for &damping in dampings {
            let error = |n: usize| error_at_end(&Config { advection, time, damping, ..config(n) }, steps(n, 0.25)).l2;
            let errors = [48, 96, 192].map(|n| (PROBLEM.side_m / n as f64, error(n)));
            let note = if advection.uses_fluxes() { format!(", damping {damping}") } else { String::new() };
            rows.push(
                Order::fit(NAME, format!("{advection:?} {time:?}{note}"), "dt ∝ h, L2", formal.into(), errors.to_vec()).pinned_to(pinned),
            );
        }
    }
    rows
}

/// Conservative advection, time step in proportion to the square of the spacing.
pub fn space() -> Vec<Order> {
    let cells = [16, 32, 64];
    let row = |damping: f32| {
        let error = |n: usize| error_at_end(&Config { damping, ..config(n) }, steps(n, 0.25 * cells[0] as f64 / n as f64)).l2;
        let errors = cells.map(|n| (PROBLEM.side_m / n as f64, error(n)));
        Order::fit(NAME, format!("Conservative RungeKutta3, damping {damping}"), "h, L2", 2.0, errors.to_vec())
    };
    vec![row(1.0), row(0.0)]
}

/// Conservative advection on one grid, against itself at a much smaller time step.
pub fn time() -> Vec<Order> {
    let cells = 16;
    let schemes = [
        (Split, Diffusion::Explicit, 1.0),
        (RungeKutta3, Diffusion::Explicit, 2.0),
        (RungeKutta3, Diffusion::CrankNicolson, 2.0),
        (RungeKutta3, Diffusion::Implicit, 1.0),
        (RungeKutta3, Diffusion::GaussSeidel { sweeps: 100 }, 1.0),
    ];
    let coarsest = steps(cells, 0.15);
    let row = |(time, diffusion, formal): (TimeScheme, Diffusion, f64)| {
        let config = Config { time, diffusion, viscosity_m2_per_s: THICK_M2_PER_S as f32, ..config(cells) };
        let reference = vortex(&config, 128 * coarsest);
        let errors = [1, 2, 4, 8].map(|finer| {
            let air = vortex(&config, finer * coarsest);
            (SECS / (finer * coarsest) as f64, velocity_difference(&air, &reference).l2)
        });
        Order::fit(NAME, format!("Conservative {time:?} {diffusion:?}"), "dt, L2", formal, errors.to_vec())
    };
    schemes.map(row).to_vec()
}
