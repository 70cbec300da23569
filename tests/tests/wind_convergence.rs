//! The wind solver approaches exact solutions at the order theory gives it.

use server::wind::advect::{Scratch, advect};
use server::wind::diffuse::{diffuse, stable_dt_secs};
use server::wind::trace::{Paths, trace};
use server::wind::{Advection, Boundary, Config, Field, Grid, Gusts, Place, Profile, Solver};
use tests::norms::{Norms, fitted_order};
use tests::problems::{TaylorGreen, drifting_hill};

const SIDE_M: f64 = 10.0;

fn square(cells: usize) -> Grid<f64> {
    let spacing = SIDE_M / cells as f64;
    Grid { cells: [cells, 1, cells], spacing_m: [spacing, 1.0, spacing], boundary: [Boundary::Wrap; 3] }
}

fn positions(grid: &Grid<f64>, place: Place) -> impl Iterator<Item = [f64; 3]> {
    let [nx, ny, nz] = grid.shape(place);
    (0..nx * ny * nz).map(move |at| grid.position_m(place, [at % nx, at / nx % ny, at / (nx * ny)]))
}

/// Error of a hill carried across a tenth of the box by a uniform wind, at a Courant number of 0.4 along x.
fn carried_hill(scheme: Advection, cells: usize) -> Norms {
    let grid = square(cells);
    let wind = [1.0, 0.5];
    let steps = cells / 4;
    let dt_secs = 0.4 * grid.spacing_m[0] / wind[0];
    let mut paths = Paths::zeros(&grid);
    trace(&grid, &vec![[wind[0], 0.0, wind[1], 0.0]; grid.len()], dt_secs, &mut paths);
    let mut hill = Field::zeros(&grid, Place::Centre);
    hill.fill(&grid, |position| drifting_hill(SIDE_M, position, wind, 0.0));
    let (mut next, mut scratch) = (hill.clone(), Scratch::new(&grid));
    for _ in 0..steps {
        advect(scheme, &grid, &paths, &hill, &mut next, &mut scratch);
        std::mem::swap(&mut hill, &mut next);
    }
    let time = steps as f64 * dt_secs;
    let exact = positions(&grid, Place::Centre).map(|position| drifting_hill(SIDE_M, position, wind, time));
    Norms::of(hill.data.iter().copied().zip(exact))
}

/// Error of the whole solver on the drifting Taylor–Green vortex after 2 s, at a given Courant number.
fn taylor_green(scheme: Advection, cells: usize, courant: f64) -> Norms {
    let problem = TaylorGreen { side_m: SIDE_M, speed_m_per_s: 1.0, drift_m_per_s: [0.5, 0.25], viscosity_m2_per_s: 0.05 };
    let grid = square(cells);
    let config = Config {
        cells: grid.cells,
        spacing_m: grid.spacing_m.map(|h| h as f32),
        boundary: grid.boundary,
        advection: scheme,
        viscosity_m2_per_s: problem.viscosity_m2_per_s as f32,
        mean_wind_m_per_s: [0.5, 0.0, 0.25],
        profile: Profile::Uniform,
        gusts: Gusts { number: 0, ..Gusts::default() },
        ..Config::default()
    };
    let mut wind = Solver::<f64>::new(&config).unwrap();
    wind.set_velocity(|position| problem.velocity(position, 0.0));
    let dt_secs = courant * grid.spacing_m[0] / 1.5;
    for _ in 0..(2.0 / dt_secs).round() as usize {
        wind.step(dt_secs as f32, &[]).unwrap();
    }
    let u = &wind.velocity().0[0];
    Norms::of(u.data.iter().copied().zip(positions(&grid, u.place).map(|position| problem.velocity(position, wind.time_secs())[0])))
}

/// Error of a decaying wave after 4 s of diffusion in `parts` steps, against one that decays like `exp(−diffusivity·k²·t)`.
fn diffused_wave(cells: usize, parts: usize, k_squared: f64) -> Norms {
    let grid = square(cells);
    let (diffusivity, wave) = (0.05, |[x, ..]: [f64; 3]| (std::f64::consts::TAU * x / SIDE_M).sin());
    let mut field = Field::zeros(&grid, Place::Centre);
    field.fill(&grid, wave);
    let mut next = field.clone();
    let dt_secs = 4.0 / parts as f64;
    assert!(dt_secs <= stable_dt_secs(&grid, diffusivity));
    for _ in 0..parts {
        diffuse(&grid, diffusivity, dt_secs, &field, &mut next);
        std::mem::swap(&mut field, &mut next);
    }
    let decay = (-diffusivity * k_squared * 4.0).exp();
    Norms::of(field.data.iter().copied().zip(positions(&grid, Place::Centre).map(|position| decay * wave(position))))
}

fn order(name: &str, cells: &[usize], error: impl Fn(usize) -> Norms) -> [f64; 3] {
    let errors: Vec<(f64, Norms)> = cells.iter().map(|&n| (SIDE_M / n as f64, error(n))).collect();
    let fit = |norm: fn(&Norms) -> f64| fitted_order(&errors.iter().map(|(h, norms)| (*h, norm(norms))).collect::<Vec<_>>());
    let orders = [fit(|n| n.l1), fit(|n| n.l2), fit(|n| n.linf)];
    println!("{name}: order in L1, L2, Linf {orders:.3?}");
    errors.iter().for_each(|(h, n)| println!("  h = {h:.4} m: {:.2e} {:.2e} {:.2e}", n.l1, n.l2, n.linf));
    orders
}

fn assert_order(found: f64, theory: f64) {
    assert!((found - theory).abs() <= 0.15, "fitted order {found:.3}, theory says {theory}");
}

#[test]
fn semi_lagrangian_advection_is_first_order() {
    let orders = order("hill, semi-Lagrangian", &[64, 128, 256, 512], |n| carried_hill(Advection::SemiLagrangian, n));
    orders.into_iter().for_each(|found| assert_order(found, 1.0));
}

#[test]
fn mac_cormack_advection_is_second_order() {
    let [l1, l2, _] = order("hill, MacCormack", &[32, 64, 128, 256], |n| carried_hill(Advection::MacCormack, n));
    assert_order(l1, 2.0);
    assert_order(l2, 2.0);
}

#[test]
fn the_solver_with_semi_lagrangian_advection_is_first_order_on_taylor_green() {
    let orders = order("Taylor–Green, semi-Lagrangian", &[32, 64, 128, 256], |n| taylor_green(Advection::SemiLagrangian, n, 0.4));
    orders.into_iter().for_each(|found| assert_order(found, 1.0));
}

/// Splitting a step into advection, forces and projection is first order in time; MacCormack advection leaves nothing else of first order.
#[test]
fn the_solver_with_mac_cormack_advection_is_second_order_in_space_and_first_in_time() {
    let orders = order("Taylor–Green, MacCormack, dt ~ h", &[32, 64, 128, 256], |n| taylor_green(Advection::MacCormack, n, 0.4));
    orders.into_iter().for_each(|found| assert_order(found, 1.0));
    let [l1, l2, _] =
        order("Taylor–Green, MacCormack, dt ~ h²", &[16, 32, 64, 128], |n| taylor_green(Advection::MacCormack, n, 8.0 / n as f64));
    assert_order(l1, 2.0);
    assert_order(l2, 2.0);
}

#[test]
fn diffusion_is_second_order_in_space_and_first_in_time() {
    let k = std::f64::consts::TAU / SIDE_M;
    // Steps in proportion to h², so that the error in time shrinks as that in space does.
    let space = order("wave, space", &[16, 32, 64], |n| diffused_wave(n, n * n, k * k));
    space.into_iter().for_each(|found| assert_order(found, 2.0));

    // The eigenvalue of the second difference leaves the error in time alone.
    let (cells, h) = (32, SIDE_M / 32.0);
    let k_of_grid = 2.0 / h * (k * h / 2.0).sin();
    let time: Vec<(f64, f64)> = [32, 64, 128, 256]
        .map(|parts: u32| (4.0 / f64::from(parts), diffused_wave(cells, parts as usize, k_of_grid * k_of_grid).l2))
        .to_vec();
    assert_order(fitted_order(&time), 1.0);
}
