//! Orders of friction between moving walls.

use prairie_wind::Diffusion::{CrankNicolson, Explicit, Implicit};
use prairie_wind::{Boundary, Config, Diffusion, Solver};

use super::Order;
use crate::air::{run, still_air};
use crate::norms::Norms;
use crate::problems::{CouetteStart, OscillatingWall};

const HEIGHT_M: f64 = 48.0;
const COUETTE: CouetteStart = CouetteStart { height_m: HEIGHT_M, speed_m_per_s: 1.0, viscosity_m2_per_s: 1.0 };
const STOKES: OscillatingWall = OscillatingWall { speed_m_per_s: 1.0, depth_m: 8.0, viscosity_m2_per_s: 1.0 };
const CELLS: [usize; 3] = [64, 128, 256];
/// Time step over spacing (s/m): friction reaches beyond a cell in a step on the finest grid, so that explicit steps are subdivided there.
const SECS_PER_M: f64 = 1.0;
const FRICTION: [(Diffusion, f64); 3] = [(Explicit, 2.0), (CrankNicolson, 2.0), (Implicit, 1.0)];

/// Orders of every friction scheme, in columns of cells between two walls: `error` gives the root of the mean square error (m/s).
fn rows(name: &'static str, error: impl Fn(Diffusion, usize) -> f64) -> Vec<Order> {
    let row = |(diffusion, formal)| {
        let errors = CELLS.map(|n| (HEIGHT_M / n as f64, error(diffusion, n)));
        Order::fit(name, format!("Conservative RungeKutta3 {diffusion:?}"), "dt ∝ h, L2", formal, errors.to_vec())
    };
    FRICTION.map(row).into()
}

/// The air between `walls` with the speed `start` (m/s), a function of the height (m). The cells are so wide that the speed along them has no limit.
fn column(diffusion: Diffusion, cells: usize, walls: [Boundary; 2], start: impl Fn(f64) -> f64) -> Solver<f64> {
    let spacing_m = [1024.0, HEIGHT_M / cells as f64, 1024.0];
    let still = still_air([1, cells, 1], spacing_m, [[Boundary::Wrap; 2], walls, [Boundary::Wrap; 2]]);
    let mut air = Solver::new(&Config { diffusion, viscosity_m2_per_s: 1.0, ..still }).expect("settings are allowed");
    air.set_velocity(|[_, y, _]| [start(y), 0.0, 0.0]);
    air
}

fn finish(mut air: Solver<f64>, secs: f64, exact: impl Fn(f64) -> f64) -> f64 {
    let [_, spacing_m, _] = air.grid().spacing_m;
    run(&mut air, secs, (secs / (SECS_PER_M * spacing_m)).round() as usize);
    Norms::of(air.samples(0).map(|([_, y, _], found)| (found, exact(y)))).l2
}

/// The start of Couette flow under a moving lid, from when friction has reached a fifth of the height to when it has reached the lower wall.
pub fn couette_start() -> Vec<Order> {
    let lid = Boundary::Lid { velocity_m_per_s: [COUETTE.speed_m_per_s as f32, 0.0, 0.0] };
    let [from, to] = [48.0, 192.0];
    rows("Couette start", |diffusion, cells| {
        let air = column(diffusion, cells, [Boundary::NoSlip, lid], |y| COUETTE.speed(y, from));
        finish(air, to - from, |y| COUETTE.speed(y, to))
    })
}

/// Half a period of Stokes' second problem, the velocity prescribed at the wall and far from it.
pub fn oscillating_wall() -> Vec<Order> {
    let secs = 96.0;
    rows("Stokes' second", |diffusion, cells| {
        let mut air = column(diffusion, cells, [Boundary::Inflow; 2], |y| STOKES.speed(y, 0.0));
        air.set_inflow(|[_, y, _], time_secs| [STOKES.speed(y, time_secs), 0.0, 0.0]);
        finish(air, secs, |y| STOKES.speed(y, secs))
    })
}
