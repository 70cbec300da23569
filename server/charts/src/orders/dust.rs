//! Orders of the advection and diffusion of dust.

use prairie_wind::Advection::{Conservative, SemiLagrangian};
use prairie_wind::{Advection, Boundary, Config, Diffusion, Dust, Solver};

use super::Order;
use crate::air::still_air;
use crate::norms::Norms;
use crate::problems::{HeatKernel, RotatingGaussian, Rotation};
use crate::turntable::{SOLID_RADIUS, turntable};

const HILL: RotatingGaussian = RotatingGaussian { rotation: Rotation { side_m: 64.0, period_secs: 64.0 }, width: 0.1 };
const HILL_SECS: f64 = 4.0;

/// A Gaussian hill carried round an eighth of a turn, at a Courant number of 0.2 under its peak.
///
/// Limiters cut the flat top of the hill; the mean error is still of second order.
pub fn rotating_gaussian() -> Vec<Order> {
    let (courant, cells) = (0.2, [64, 96, 128]);
    let row = |&advection: &Advection| {
        let side_m = HILL.rotation.side_m;
        let errors = cells.map(|n| (side_m / n as f64, hill_error(advection, n, courant).l1));
        Order::fit("Rotating hill", format!("{advection:?}"), "dt ∝ h, L1", advection.order().into(), errors.to_vec())
    };
    Advection::ALL.iter().map(row).collect()
}

fn hill_error(advection: Advection, cells: usize, courant: f64) -> Norms {
    let side_m = HILL.rotation.side_m;
    let mut air = turntable::<f64>(HILL.rotation, advection, cells);
    air.set_dust(|position| HILL.density(position, 0.0));
    let [u, ..] = HILL.rotation.velocity([0.0, 0.0, 0.75 * side_m]);
    let steps = (HILL_SECS * u.abs() * cells as f64 / (courant * side_m)).round();
    (0..steps as usize).for_each(|_| air.step_dust(HILL_SECS / steps).expect("within the limits"));
    let turns = |[x, _, z]: [f64; 3]| (x / side_m - 0.5).hypot(z / side_m - 0.5) < SOLID_RADIUS;
    Norms::of(
        air.dust_samples().filter(|(position, _)| turns(*position)).map(|(position, found)| (found, HILL.density(position, HILL_SECS))),
    )
}

const HEAT: HeatKernel = HeatKernel { side_m: [Some(8.0), None, Some(8.0)], centre_m: [3.3, 0.0, 4.6], diffusivity_m2_per_s: 0.125 };
/// Start and end of the heat problem (s).
const HEAT_SECS: [f64; 2] = [2.0, 4.0];

/// Every diffusion scheme that is split from advection, with its order in time; and explicit diffusion in the fluxes of conservative transport.
const DIFFUSIONS: [(Diffusion, Advection, f64); 5] = [
    (Diffusion::Explicit, SemiLagrangian, 1.0),
    (Diffusion::GaussSeidel { sweeps: 100 }, SemiLagrangian, 1.0),
    (Diffusion::Implicit, SemiLagrangian, 1.0),
    (Diffusion::CrankNicolson, SemiLagrangian, 2.0),
    (Diffusion::Explicit, Conservative, 3.0),
];

fn heat(diffusion: Diffusion, advection: Advection, cells: usize, steps: usize) -> Vec<([f64; 3], f64)> {
    let spacing_m = 8.0 / cells as f64;
    let dust = Dust { advection, diffusivity_m2_per_s: HEAT.diffusivity_m2_per_s as f32, release_per_s: 0.0, settling_per_s: 0.0 };
    let config = Config { diffusion, dust: Some(dust), ..still_air([cells, 1, cells], [spacing_m; 3], [[Boundary::Wrap; 2]; 3]) };
    let mut air = Solver::<f64>::new(&config).expect("settings are allowed");
    let [from, to] = HEAT_SECS;
    air.set_dust(|position| HEAT.density(position, from));
    (0..steps).for_each(|_| air.step_dust((to - from) / steps as f64).expect("within the limits"));
    air.dust_samples().collect()
}

fn diffusion_name(diffusion: Diffusion, advection: Advection) -> String {
    if advection == Conservative { format!("{diffusion:?}, in conservative fluxes") } else { format!("{diffusion:?}") }
}

/// The heat kernel, with `κ·dt/h²` = 1/20 on every grid.
pub fn heat_space() -> Vec<Order> {
    let cells = [16, 32, 64];
    let row = |(diffusion, advection, _): (Diffusion, Advection, f64)| {
        let errors = cells.map(|n| {
            let spacing_m = 8.0 / n as f64;
            let steps = ((HEAT_SECS[1] - HEAT_SECS[0]) * 20.0 * HEAT.diffusivity_m2_per_s / (spacing_m * spacing_m)).round() as usize;
            let found = heat(diffusion, advection, n, steps);
            (spacing_m, Norms::of(found.into_iter().map(|(position, found)| (found, HEAT.density(position, HEAT_SECS[1])))).l2)
        });
        Order::fit("Heat kernel", diffusion_name(diffusion, advection), "h, L2", 2.0, errors.to_vec())
    };
    DIFFUSIONS.map(row).to_vec()
}

/// The heat kernel on one grid, against itself at a much smaller time step.
pub fn heat_time() -> Vec<Order> {
    let cells = 16;
    let spacing_m = 8.0 / cells as f64;
    let coarsest = ((HEAT_SECS[1] - HEAT_SECS[0]) * 8.0 * HEAT.diffusivity_m2_per_s / (spacing_m * spacing_m)).round() as usize;
    let row = |(diffusion, advection, formal)| {
        let reference = heat(diffusion, advection, cells, 128 * coarsest);
        let errors = [1, 2, 4, 8].map(|finer| {
            let found = heat(diffusion, advection, cells, finer * coarsest);
            let norms = Norms::of(found.iter().zip(&reference).map(|((_, a), (_, b))| (*a, *b)));
            ((HEAT_SECS[1] - HEAT_SECS[0]) / (finer * coarsest) as f64, norms.l2)
        });
        Order::fit("Heat kernel", diffusion_name(diffusion, advection), "dt, L2", formal, errors.to_vec())
    };
    DIFFUSIONS.map(row).to_vec()
}
