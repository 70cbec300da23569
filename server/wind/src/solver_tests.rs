use glam::Vec3;

use super::super::pressure::{Effort, IterativeMethod};
use super::super::{Advection, Boundary, Dust, Front, Gusts, Intensity, Jet, Primitive, Profile, Shape, StepError, TimeScheme};
use super::*;

const DT_SECS: f64 = 1.0 / 60.0;

/// Every allowed pair of advection and time scheme.
fn schemes() -> impl Iterator<Item = (Advection, TimeScheme)> {
    let pairs = Advection::ALL.iter().flat_map(|&advection| TimeScheme::ALL.iter().map(move |&time| (advection, time)));
    pairs.filter(|&(advection, time)| time.allows(advection))
}

fn dusty() -> Config {
    Config { dust: Some(Dust::default()), ..Config::default() }
}

fn helicopter() -> Jet {
    Jet { position_m: Vec3::new(100.0, 6.0, 120.0), radius_m: 12.0, velocity_m_per_s: Vec3::new(0.0, -10.0, 0.0), rate_per_s: 2.0 }
}

fn run(config: &Config, threads: usize, steps: usize) -> State<f32> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| {
        let mut wind = WindSolver::new(config).unwrap();
        for _ in 0..steps {
            wind.step(DT_SECS, &[helicopter()]).unwrap();
        }
        wind.state()
    })
}

fn bits(state: &State<f32>) -> Vec<u32> {
    state.velocity.iter().chain(&state.pressure_gradient).chain([&state.dust]).flatten().map(|x| x.to_bits()).collect()
}

#[test]
fn same_seed_same_bits_on_one_and_two_threads() {
    // Large enough to run in parallel.
    let large = Config { cells: [48, 16, 56], ..dusty() };
    for config in [dusty(), large] {
        let one = run(&config, 1, 20);
        assert_eq!(bits(&one), bits(&run(&config, 1, 20)));
        assert_eq!(bits(&one), bits(&run(&config, 2, 20)));
        assert_ne!(bits(&one), bits(&run(&Config { seed: 2, ..config.clone() }, 2, 20)));
    }
}

#[test]
fn a_restored_state_goes_on_with_the_same_bits() {
    let mut wind = WindSolver::new(&dusty()).unwrap();
    for _ in 0..30 {
        wind.step(DT_SECS, &[]).unwrap();
    }
    let state = wind.state();
    let mut other = WindSolver::new(&dusty()).unwrap();
    other.restore(&state).unwrap();
    for _ in 0..30 {
        assert_eq!(wind.step(DT_SECS, &[]), other.step(DT_SECS, &[]));
    }
    assert_eq!(bits(&wind.state()), bits(&other.state()));

    let short = State { dust: Vec::new(), ..state };
    assert_eq!(other.restore(&short), Err(StateError { what: "dust", found: 0, expected: 8192 }));
}

/// Speed (m/s) of the default wind at 1 m: mean over time and place, and its standard deviation over both.
#[test]
fn the_wind_stays_lively() {
    let mut wind = WindSolver::new(&Config::default()).unwrap();
    let dt_secs = 0.05;
    for minute in 0..10 {
        let (mut sum, mut squares, mut n) = (0.0, 0.0, 0.0);
        for step in 0..1200 {
            let report = wind.step(dt_secs, &[]).unwrap();
            assert!(report.divergence_rms_rel < 1e-5, "{report:?}");
            assert!(report.courant < 1.0, "{report:?}");
            if step % 40 == 0 {
                for (at, velocity) in wind.cell_velocities().enumerate() {
                    if at / 32 % 8 == 0 {
                        let speed = f64::from((velocity.x * velocity.x + velocity.z * velocity.z).sqrt());
                        sum += speed;
                        squares += speed * speed;
                        n += 1.0;
                    }
                }
            }
        }
        let mean = sum / n;
        let deviation = (squares / n - mean * mean).sqrt();
        println!("minute {minute}: speed at 1 m {mean:.2} m/s ± {deviation:.2} ({:.0} %)", 100.0 * deviation / mean);
        assert!((2.0..5.0).contains(&mean), "minute {minute}: mean speed {mean}");
        // Gusts need the first minute to build up.
        let least = if minute == 0 { 0.2 } else { 0.28 };
        assert!((least..0.48).contains(&(deviation / mean)), "minute {minute}: deviation {deviation} of mean {mean}");
    }
}

/// Correlation of the speed 1 m above the ground with the speed `secs` later and `cells` further along x.
fn correlation(wind: &mut WindSolver, secs: f64, cells: usize) -> f64 {
    let along = |wind: &WindSolver| -> Vec<f64> {
        let layer = wind.cell_velocities().enumerate().filter(|(at, _)| at / 32 % 8 == 0).map(|(_, velocity)| f64::from(velocity.x));
        let layer: Vec<f64> = layer.collect();
        let mean = layer.iter().sum::<f64>() / layer.len() as f64;
        layer.into_iter().map(|x| x - mean).collect()
    };
    let before = along(wind);
    for _ in 0..(secs / 0.05) as usize {
        wind.step(0.05, &[]).unwrap();
    }
    let after = along(wind);
    let dot = |a: &[f64], b: &[f64], shift: usize| -> f64 { (0..a.len()).map(|at| a[at] * b[at / 32 * 32 + (at + shift) % 32]).sum() };
    dot(&before, &after, cells) / (dot(&before, &before, 0) * dot(&after, &after, 0)).sqrt()
}

#[test]
fn gusts_travel_with_the_wind() {
    let config = Config { mean_wind_m_per_s: [5.0, 0.0, 0.0], ..Config::default() };
    let mut wind = WindSolver::new(&config).unwrap();
    (0..1200).for_each(|_| assert!(wind.step(0.05, &[]).is_ok()));
    for cells in 0..5 {
        println!("now {cells} cells on: {:.2}", correlation(&mut wind, 0.0, cells));
    }
    let mean = |wind: &mut WindSolver, cells| (0..10).map(|_| correlation(wind, 4.0, cells)).sum::<f64>() / 10.0;
    let along: Vec<f64> = (0..5).map(|cells| mean(&mut wind, cells)).collect();
    println!("4 s later: {along:.2?}");
    assert!(along[2] > 0.35 && along[2] > along[0] + 0.1, "{along:?}");
}

#[test]
fn without_gusts_the_mean_wind_blows_on() {
    for (advection, time) in schemes() {
        let config =
            Config { gusts: Gusts { number: 0, ..Gusts::default() }, advection, time, viscosity_m2_per_s: 0.0, ..Config::default() };
        let mut wind = WindSolver::new(&config).unwrap();
        let start = Vec3::from(wind.velocity_at([1.0, 3.0, 2.0]));
        for _ in 0..100 {
            wind.step(DT_SECS, &[]).unwrap();
        }
        let end = Vec3::from(wind.velocity_at([1.0, 3.0, 2.0]));
        assert!((end - start).length() < 1e-4, "{start} became {end}");
    }
}

#[test]
fn a_downwash_blows_down_and_outwards_along_the_ground() {
    let config = Config {
        mean_wind_m_per_s: [0.0; 3],
        gusts: Gusts { number: 0, ..Gusts::default() },
        spacing_m: [4.0, 2.0, 4.0],
        ..Config::default()
    };
    let mut wind = WindSolver::new(&config).unwrap();
    let jet = Jet { position_m: Vec3::new(64.0, 8.0, 64.0), ..helicopter() };
    for _ in 0..180 {
        wind.step(DT_SECS, &[jet]).unwrap();
    }
    assert!(wind.velocity_at([64.0, 8.0, 64.0])[1] < -3.0);
    assert_eq!(wind.velocity_at([64.0, 0.0, 64.0])[1], 0.0);
    for out in [Vec3::X, -Vec3::X, Vec3::Z, -Vec3::Z] {
        let speed = Vec3::from(wind.velocity_at((Vec3::new(64.0, 1.0, 64.0) + 12.0 * out).to_array())).dot(out);
        assert!(speed > 1.0, "outflow along {out}: {speed}");
    }
}

#[test]
fn a_closed_box_and_a_wrapped_one_run() {
    for boundary in [[[Boundary::FreeSlip; 2]; 3], [[Boundary::Wrap; 2]; 3]] {
        let config = Config { boundary, mean_wind_m_per_s: [0.0; 3], profile: Profile::Uniform, cells: [9, 6, 10], ..dusty() };
        let mut wind = WindSolver::new(&config).unwrap();
        for _ in 0..600 {
            let report = wind.step(0.1, &[]).unwrap();
            assert!(report.divergence_rms_rel < 1e-5 && report.kinetic_energy_m2_per_s2 < 100.0, "{report:?}");
        }
        let dust: Vec<f32> = wind.dust().unwrap().collect();
        assert!(dust.iter().all(|&density| density >= 0.0) && dust.iter().any(|&density| density > 0.1));
    }
}

#[test]
fn absurd_courant_numbers_are_survived() {
    let dust = Some(Dust { advection: Advection::MacCormack, diffusivity_m2_per_s: 0.0, ..Dust::default() });
    for (advection, time) in schemes().filter(|(advection, _)| !advection.uses_fluxes()) {
        let mut wind =
            WindSolver::new(&Config { advection, time, cells: [16, 8, 16], viscosity_m2_per_s: 0.0, dust, ..Config::default() }).unwrap();
        for _ in 0..200 {
            let report = wind.step(100.0, &[]).unwrap();
            assert!(report.kinetic_energy_m2_per_s2 < 1e6, "{report:?}");
        }
    }
}

#[test]
fn bad_steps_are_refused_and_change_nothing() {
    let mut wind = WindSolver::new(&Config { viscosity_m2_per_s: 1000.0, ..Config::default() }).unwrap();
    let before = wind.state();
    for dt_secs in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(wind.step(dt_secs, &[]), Err(StepError::BadTimeStep { .. })));
    }
    let jet = Jet { radius_m: f32::NAN, ..helicopter() };
    assert!(matches!(wind.step(DT_SECS, &[helicopter(), jet]), Err(StepError::BadJet { index: 1, .. })));
    let error = wind.step(10.0, &[]).unwrap_err();
    assert!(matches!(error, StepError::TooLong { what: "viscosity_m2_per_s", .. }), "{error}");
    assert_eq!(wind.state(), before);
    assert!(wind.step(DT_SECS, &[]).unwrap().substeps > 1);
}

#[test]
fn a_nan_is_caught_in_its_step_with_the_cell() {
    let mut wind = WindSolver::new(&Config { gusts: Gusts { number: 0, ..Gusts::default() }, ..Config::default() }).unwrap();
    let mut state = wind.state();
    state.velocity[1][5 + 32 * (4 + 9 * 7)] = f32::NAN;
    wind.restore(&state).unwrap();
    let error = wind.step(DT_SECS, &[]).unwrap_err();
    assert!(matches!(error, StepError::NotFinite { time_secs: 0.0, .. }), "{error}");
    assert!(error.to_string().contains("cell ["), "{error}");
}

#[test]
fn a_step_beyond_the_courant_limit_is_cut_or_refused() {
    let config = Config { gusts: Gusts { number: 0, ..Gusts::default() }, mean_wind_m_per_s: [20.0, 0.0, 0.0], ..Config::default() };
    let mut wind = WindSolver::new(&config).unwrap();
    assert_eq!(wind.step(0.1, &[]).unwrap().substeps, 1);
    let report = wind.step(10.0, &[]).unwrap();
    assert!(report.courant > 20.0 && report.substeps >= 15, "{report:?}");
    let before = wind.state();
    let error = wind.step(1000.0, &[]).unwrap_err();
    assert!(matches!(error, StepError::TooLong { what: "the Courant number of conservative advection", .. }), "{error}");
    assert_eq!(wind.state(), before);
}

#[test]
fn air_flows_round_what_is_solid() {
    let pressure = Pressure::Iterative(IterativeMethod::Multigrid, Effort { tolerance: 1e-6, sweeps: 50 });
    let sides = [Boundary::Inflow, Boundary::Outflow];
    let still = Gusts { number: 0, ..Gusts::default() };
    let config = Config {
        cells: [24, 8, 16],
        spacing_m: [1.0; 3],
        boundary: [sides, [Boundary::FreeSlip; 2], [Boundary::FreeSlip; 2]],
        mean_wind_m_per_s: [2.0, 0.0, 0.0],
        profile: Profile::Uniform,
        gusts: still,
        pressure,
        ..Config::default()
    };
    let in_the_way = |[x, y, z]: [f32; 3]| (8.0..12.0).contains(&x) && y < 5.0 && (4.0..10.0).contains(&z);
    let mut wind = WindSolver::new(&config).unwrap();
    wind.set_solid(in_the_way).unwrap();
    for _ in 0..100 {
        let report = wind.step(0.1, &[]).unwrap();
        assert!(report.divergence_rms_rel < 1e-5 && report.pressure_residual <= 1e-6, "{report:?}");
    }
    assert_eq!(wind.velocity_at([10.0, 2.0, 7.0]), [0.0; 3]);
    assert!(wind.velocity_at([10.0, 7.0, 7.0])[0] > 2.5, "faster above: {:?}", wind.velocity_at([10.0, 7.0, 7.0]));
    let outflow: f32 = wind.samples(0).filter(|(at, _)| at[0] == 24.0).map(|(_, u)| u).sum::<f32>() / 128.0;
    assert!((outflow - 2.0).abs() < 1e-3, "what comes in goes out: {outflow}");

    let mut direct = WindSolver::new(&Config { pressure: Pressure::Direct, ..config }).unwrap();
    assert_eq!(direct.set_solid(in_the_way), Err(SolidError::Pressure));
}

/// Air in the open around one primitive, after a while.
fn round(shape: Shape) -> WindSolver {
    let primitive = Primitive {
        shape,
        position_m: [32.0, 8.0, 32.0],
        drift_m_per_s: [0.0; 2],
        radius_m: 12.0,
        speed_m_per_s: 5.0,
        direction: [0.0, 1.0],
        dust: 0.0,
        intensity: Intensity::Steady,
        front: Front::default(),
    };
    let config = Config {
        cells: [32, 16, 32],
        spacing_m: [2.0, 1.0, 2.0],
        boundary: [[Boundary::Outflow; 2], [Boundary::FreeSlip, Boundary::Outflow], [Boundary::Outflow; 2]],
        mean_wind_m_per_s: [0.0; 3],
        gusts: Gusts { number: 0, ..Gusts::default() },
        primitives: vec![primitive],
        ..Config::default()
    };
    let mut wind = WindSolver::new(&config).unwrap();
    (0..100).for_each(|_| assert!(wind.step(0.05, &[]).unwrap().courant < 2.0));
    wind
}

#[test]
fn primitives_blow_as_their_names_say() {
    let at = |wind: &WindSolver, x: f32, y: f32, z: f32| Vec3::from(wind.velocity_at([32.0 + x, 8.0 + y, 32.0 + z]));
    let uniform = at(&round(Shape::Uniform), 0.0, 0.0, 0.0);
    assert!(uniform.z > 2.5 && uniform.z < 5.0 && uniform.x.abs() < 0.1, "{uniform}");
    let vortex = round(Shape::Vortex);
    assert!(at(&vortex, 6.0, 0.0, 0.0).z < -2.0 && at(&vortex, 0.0, 0.0, 6.0).x > 2.0, "{}", at(&vortex, 6.0, 0.0, 0.0));
    let cyclone = round(Shape::Cyclone);
    assert!(at(&cyclone, 6.0, 0.0, 0.0).z < -1.5 && at(&cyclone, 0.0, 0.0, 0.0).y > 1.0, "{}", at(&cyclone, 0.0, 0.0, 0.0));
    let fastest = |wind: &WindSolver, sign: f32| (0..24).map(|r| sign * at(wind, r as f32 * 0.5, 0.0, 0.0).x).fold(0.0, f32::max);
    for (shape, sign) in [(Shape::Source, 1.0), (Shape::Sink, -1.0)] {
        let speed = fastest(&round(shape), sign);
        assert!((4.0..7.0).contains(&speed), "{shape:?}: {speed}");
    }
}

/// The server documentation states these figures.
#[test]
fn memory_is_as_stated() {
    let memory = |config: &Config| WindSolver::new(config).unwrap().memory_bytes();
    let default = Config::default();
    let dusty = Config { dust: Some(Dust::default()), ..Config::default() };
    let traced = Config { advection: Advection::Bfecc, time: TimeScheme::Reflection, ..Config::default() };
    let large = Config { cells: [64, 32, 64], ..Config::default() };
    println!("{} {} {} {}", memory(&default), memory(&dusty), memory(&traced), memory(&large));
    assert!((1_200_000..1_500_000).contains(&memory(&default)));
    assert!((1_400_000..1_900_000).contains(&memory(&dusty)));
    assert!((1_900_000..2_500_000).contains(&memory(&traced)));
    assert!((13_000_000..15_000_000).contains(&memory(&large)));
}

/// The old pressure gradient passes through friction: a wave of it that friction reversed would double in every step.
#[test]
fn stiff_friction_and_kept_pressure_lose_energy_together() {
    for diffusion in [Diffusion::Implicit, Diffusion::CrankNicolson] {
        let config = Config {
            cells: [8, 6, 7],
            spacing_m: [1.0; 3],
            boundary: [[Boundary::NoSlip; 2], [Boundary::FreeSlip, Boundary::NoSlip], [Boundary::NoSlip, Boundary::Outflow]],
            diffusion,
            viscosity_m2_per_s: 300.0,
            mean_wind_m_per_s: [0.0; 3],
            relaxation_per_s: 0.0,
            profile: Profile::Uniform,
            gusts: Gusts { number: 0, ..Gusts::default() },
            ..Config::default()
        };
        let mut wind = Solver::<f64>::new(&config).unwrap();
        wind.set_velocity(|[x, y, z]| [(3.0 * x + y).sin(), (2.0 * y - z).cos(), (x + 3.0 * z).sin()]);
        let squares = |wind: &Solver<f64>| (0..3).flat_map(|axis| wind.samples(axis)).map(|(_, speed)| speed * speed).sum::<f64>();
        let start = 0.5 * squares(&wind) / wind.grid().len() as f64;
        let energies: Vec<f64> = (0..200).map(|_| wind.step(0.1, &[]).unwrap().kinetic_energy_m2_per_s2).collect();
        assert!(energies.iter().all(|energy| *energy <= start), "{diffusion:?}: {start}, {energies:?}");
        assert!(energies[199] < 1e-6 * start, "{diffusion:?}: {:e} of {start:e}", energies[199]);
    }
}
