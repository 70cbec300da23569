//! The wind's methods become unstable at their theoretical limits; those without a limit never do.

use prairie_charts::limits::{Limit, Transport, dust_bounds, explicit_diffusion};
use prairie_charts::random_winds::Random;
use prairie_wind::diffuse::{Implicit, Portion, diffuse};
use prairie_wind::pressure::{Effort, IterativeMethod};
use prairie_wind::{
    Advection, Boundary, Config, Diffusion, Dust, Field, Grid, Gusts, Location, Pressure, Profile, Solver, StepError, TimeScheme,
};

fn report(limit: &Limit) {
    println!(
        "{:50} {:16} theory {:8.5} measured {:8.5} ratio {:.4}",
        limit.scheme,
        limit.number,
        limit.theory,
        limit.measured,
        limit.ratio()
    );
}

#[test]
fn explicit_diffusion_becomes_unstable_at_its_limit() {
    // Cells so wide along an axis with a single one that it hardly counts in the step that is allowed.
    let wide = 1e4;
    let boxes = [
        ("cubes", [8, 8, 8], [1.0; 3], [Boundary::Wrap; 2]),
        ("flat cells", [8, 8, 8], [4.0, 1.0, 2.0], [Boundary::Wrap; 2]),
        ("squares", [8, 8, 1], [1.0; 3], [Boundary::Wrap; 2]),
        ("a line", [8, 1, 1], [1.0; 3], [Boundary::Wrap; 2]),
        ("flat cells between walls", [8, 8, 8], [4.0, 1.0, 2.0], [Boundary::NoSlip; 2]),
        ("a line over a wall", [1, 32, 1], [wide, 1.0, wide], [Boundary::NoSlip, Boundary::FreeSlip]),
        ("a line between walls", [1, 5, 1], [wide, 1.0, wide], [Boundary::Inflow; 2]),
        ("two cells between walls", [1, 2, 1], [wide, 1.0, wide], [Boundary::NoSlip; 2]),
    ];
    for (name, cells, spacing_m, across) in boxes {
        for midpoint in [false, true] {
            let limit = explicit_diffusion(name, cells, spacing_m, across, midpoint);
            report(&limit);
            assert!((limit.ratio() - 1.0).abs() <= 0.03, "{limit:?}");
        }
    }
}

fn transports() -> Vec<(&'static str, Transport)> {
    let line = Transport { cells: [16, 1, 1], spacing_m: [1.0; 3], air_m_per_s: [1.0, 0.0, 0.0], diffusivity_m2_per_s: 0.0, damping: 0.0 };
    let square = Transport { cells: [16, 16, 1], spacing_m: [1.0, 0.5, 1.0], air_m_per_s: [1.0, -0.7, 0.0], ..line };
    let cube = Transport { cells: [8, 8, 8], spacing_m: [1.0, 0.5, 2.0], air_m_per_s: [1.0, -0.7, 0.5], ..line };
    let still = [0.0; 3];
    vec![
        ("advection, line", line),
        ("advection, square", square),
        ("advection, cube", cube),
        ("diffusion, line", Transport { air_m_per_s: still, diffusivity_m2_per_s: 1.0, ..line }),
        ("diffusion, cube", Transport { air_m_per_s: still, diffusivity_m2_per_s: 1.0, ..cube }),
        ("advection, full damping, line", Transport { damping: 1.0, ..line }),
        ("advection, full damping, square", Transport { damping: 1.0, ..square }),
        ("advection, full damping, cube", Transport { damping: 1.0, ..cube }),
        ("advection, half damping, square", Transport { damping: 0.5, ..square }),
        ("both, little diffusion, square", Transport { diffusivity_m2_per_s: 0.02, ..square }),
        ("both, square", Transport { diffusivity_m2_per_s: 0.2, ..square }),
        ("both, much diffusion, cube", Transport { diffusivity_m2_per_s: 1.0, ..cube }),
        ("both, full damping, square", Transport { diffusivity_m2_per_s: 0.1, damping: 1.0, ..square }),
        ("both, full damping, cube", Transport { diffusivity_m2_per_s: 0.1, damping: 1.0, ..cube }),
    ]
}

#[test]
fn transport_becomes_unstable_where_its_amplification_exceeds_1() {
    for (name, transport) in transports() {
        let limit = transport.limit(name);
        report(&limit);
        assert!((limit.ratio() - 1.0).abs() <= 0.03, "{limit:?}");
    }
    let [line, _, cube] = [0, 1, 2].map(|n| transports()[n].1);
    assert!((line.limit("").measured / 3.0f64.sqrt() - 1.0).abs() < 0.03);
    let courant_per_s: f64 = (0..3).map(|axis| cube.air_m_per_s[axis].abs() / cube.spacing_m[axis]).sum();
    assert!((cube.limit("").measured * courant_per_s / 3.0f64.sqrt() - 1.0).abs() < 0.03);
}

/// The limit by `transport::stable_dt_secs` never exceeds the true one, over all wave numbers and mixtures; `left` is the margin.
#[test]
fn the_stable_step_of_transport_never_exceeds_the_limit() {
    let mut left = [f64::INFINITY, 0.0];
    let mut random = Random::new(5);
    for _ in 0..300 {
        let transport = Transport {
            cells: [16, 16, 1],
            spacing_m: [0; 3].map(|_| random.scale(0.1, 10.0)),
            air_m_per_s: [0; 3].map(|_| random.of(&[0.0, 1.0, -1.0]) * random.scale(0.01, 10.0)),
            diffusivity_m2_per_s: random.of(&[0.0, 1.0]) * random.scale(1e-3, 1e2),
            damping: random.of(&[0.0, 0.5, 1.0]),
        };
        let air = [transport.air_m_per_s[0], transport.air_m_per_s[1], 0.0];
        let transport = Transport { air_m_per_s: air, ..transport };
        // A single cell along z, so wide that it has no effect.
        let spacing_m = [transport.spacing_m[0], transport.spacing_m[1], 1e9];
        let grid = Grid { cells: transport.cells, spacing_m, boundary: [[Boundary::Wrap; 2]; 3] };
        let allowed = prairie_wind::transport::stable_dt_secs(&grid, air.map(f64::abs), transport.diffusivity_m2_per_s);
        if allowed.is_finite() {
            let amplification = transport.amplification(allowed, 64);
            assert!(amplification <= 1.0 + 1e-9, "{transport:?}: {amplification} at {allowed} s");
            let mut longest = 1.0;
            while transport.amplification(longest * allowed, 64) <= 1.0 + 1e-9 {
                longest += 0.01;
            }
            left = [left[0].min(longest), left[1].max(longest)];
        }
    }
    println!("the true limit is {:.2} to {:.2} times what is allowed", left[0], left[1]);
    assert!(left[1] < 2.0);
}

/// Theory's 1/2 suffices for any divergence-free flow; the measured limit may be higher, since the noise is not the worst case.
#[test]
fn limited_dust_stays_bounded_up_to_a_courant_number_of_one_half() {
    for (name, cells, uniform) in [
        ("uniform air, line", [64, 1, 1], true),
        ("uniform air, square", [24, 24, 1], true),
        ("uniform air, cube", [12, 12, 12], true),
        ("turbulent air, square", [24, 24, 1], false),
        ("turbulent air, cube", [12, 12, 12], false),
    ] {
        let limit = dust_bounds(name, cells, uniform);
        report(&limit);
        assert!(limit.ratio() >= 1.0, "{limit:?}");
    }
}

/// Largest growth factor of the norm of noise per diffusion step.
fn growth(scheme: Diffusion, portion: Portion, number: f64) -> f64 {
    let grid = Grid { cells: [8; 3], spacing_m: [1.0; 3], boundary: [[Boundary::NoSlip; 2]; 3] };
    let walls = prairie_wind::boundary::BoundaryConditions::new(&grid, Box::new(|_, _| [0.0; 3]));
    let mut field = Field::<f64>::zeros(&grid, Location::Face(0));
    let mut random = Random::new(3);
    field.data.iter_mut().for_each(|value| *value = random.between(-1.0, 1.0));
    walls.apply_to_component(&mut field);
    let (mut even, mut odd, mut implicit) = (field.clone(), field.clone(), Implicit::new(&grid));
    let norm = |field: &Field<f64>| field.values(&grid).map(|value| value * value).sum::<f64>();
    let mut largest = 0.0f64;
    for _ in 0..50 {
        let before = norm(&field);
        diffuse(scheme, portion, &grid, 1.0, number, &mut field, [&mut even, &mut odd], Some(&mut implicit), |field, _| {
            walls.apply_to_component(field)
        });
        let after = norm(&field);
        if before > 1e-200 {
            largest = largest.max((after / before).sqrt());
        }
    }
    largest
}

#[test]
fn implicit_friction_never_grows() {
    let schemes =
        [Diffusion::Implicit, Diffusion::CrankNicolson, Diffusion::GaussSeidel { sweeps: 1 }, Diffusion::GaussSeidel { sweeps: 20 }];
    for scheme in schemes {
        for portion in [Portion::Whole, Portion::First, Portion::Second] {
            for number in [0.1, 1.0, 1e2, 1e4, 1e6] {
                let growth = growth(scheme, portion, number);
                assert!(growth <= 1.0 + 1e-9, "{scheme:?} {portion:?} at nu dt/h^2 = {number}: {growth}");
            }
        }
    }
    for portion in [Portion::Whole, Portion::First] {
        let growth = growth(Diffusion::Explicit, portion, 100.0);
        assert!(growth <= 1.0 + 1e-9, "explicit, cut into parts, {portion:?}: {growth}");
    }
}

/// Turbulent air with a uniform wind of 1 m/s in a box of 6³ cells of 1 m.
fn turbulent(config: Config) -> Solver<f32> {
    turbulent_in(6, config)
}

/// The same in a box of `side`³ cells.
fn turbulent_in(side: usize, config: Config) -> Solver<f32> {
    let config = Config {
        cells: [side; 3],
        spacing_m: [1.0; 3],
        mean_wind_m_per_s: [0.0; 3],
        relaxation_per_s: 0.0,
        profile: Profile::Uniform,
        gusts: Gusts { number: 0, ..Gusts::default() },
        ..config
    };
    let mut solver = Solver::new(&config).expect("a legal box");
    solver.set_velocity(|position: [f32; 3]| {
        let mut random = Random::new(position.iter().fold(9, |seed, x| Random::new(seed ^ u64::from(x.to_bits())).bits()));
        [1.0 + random.between(-1.0, 1.0) as f32, random.between(-1.0, 1.0) as f32, 1.0 + random.between(-1.0, 1.0) as f32]
    });
    solver
}

fn energy(solver: &Solver<f32>) -> f64 {
    solver.velocity().0.iter().flat_map(|field| field.values(solver.grid())).map(|speed| f64::from(speed) * f64::from(speed)).sum()
}

/// 1 000 steps in 6³ cells; 10 000 in 12³, some twelve minutes, with `PRAIRIE_LARGE` set. The time step stays fixed, so that a uniform wind of 1 m/s has the
/// stated Courant number.
#[test]
fn methods_without_a_limit_are_stable_at_any_courant_number() {
    let (side, steps) = if std::env::var_os("PRAIRIE_LARGE").is_some() { (12, 10_000) } else { (6, 1_000) };
    for &advection in Advection::ALL.iter().filter(|advection| !advection.uses_fluxes()) {
        for time in [TimeScheme::Split, TimeScheme::Reflection] {
            let mut growth = [0.0f64; 4];
            for diffusion in [Diffusion::Implicit, Diffusion::CrankNicolson, Diffusion::GaussSeidel { sweeps: 5 }] {
                for (growth, courant) in growth.iter_mut().zip([1.0, 10.0, 100.0, 1000.0]) {
                    let config = Config { advection, time, diffusion, viscosity_m2_per_s: 1e-3, ..Config::default() };
                    let mut solver = turbulent_in(side, config);
                    let start = energy(&solver);
                    for _ in 0..steps {
                        let report = solver.step(courant, &[]).expect("no limit");
                        assert_eq!(report.substeps, 1);
                        *growth = growth.max(energy(&solver) / start);
                    }
                    assert!(energy(&solver).is_finite());
                }
            }
            println!("{advection:?} {time:?}: largest energy over the start's at Courant 1, 10, 100, 1000: {growth:.4?}");
            assert!(growth.iter().all(|&growth| growth <= 1.0), "{advection:?} {time:?}: {growth:?}");
        }
    }
}

#[test]
fn too_long_a_step_is_subdivided_or_rejected_and_never_clamped() {
    let explicit = |viscosity_m2_per_s| Config { viscosity_m2_per_s, ..Config::default() };
    let mut solver = turbulent(explicit(0.2));
    let report = solver.step(10.0, &[]).expect("some parts");
    assert!(report.substeps > 10 && (solver.time_secs() - 10.0).abs() < 1e-12, "{report:?}");

    let before = solver.state();
    let refused = solver.step(1e4, &[]);
    let Err(StepError::TooLong { what, needed, .. }) = &refused else { panic!("{refused:?}") };
    assert!(what.contains("viscosity") && *needed > 256.0, "{refused:?}");
    assert!(refused.as_ref().err().is_some_and(|error| error.to_string().contains("allowed: 256")));
    assert!(solver.state() == before);

    let mut solver = turbulent(explicit(0.0));
    let before = solver.state();
    let refused = solver.step(1e4, &[]);
    assert!(matches!(&refused, Err(StepError::TooLong { what, .. }) if what.contains("Courant")), "{refused:?}");
    assert!(solver.state() == before);

    let config = Config { advection: Advection::MacCormack, time: TimeScheme::Split, dust: Some(Dust::default()), ..explicit(0.0) };
    let mut solver = turbulent(config);
    let before = solver.state();
    let refused = solver.step(1e3, &[]);
    assert!(matches!(&refused, Err(StepError::TooLong { what, .. }) if what.contains("dust")), "{refused:?}");
    assert!(solver.state() == before);
}

/// Forces that would exceed the Courant limit within a step cause sub-steps or a rejection beforehand.
#[test]
fn strong_forces_subdivide_the_step() {
    let still = |force: f32| {
        let config = Config { body_force_m_per_s2: [force, 0.0, 0.0], viscosity_m2_per_s: 0.0, ..Config::default() };
        let mut solver = turbulent(config);
        solver.set_velocity(|_| [0.0; 3]);
        solver
    };
    let mut solver = still(10.0);
    let report = solver.step(2.0, &[]).expect("some parts");
    assert!(report.substeps > 4, "{report:?}");
    assert!((energy(&solver) / 216.0 - 400.0).abs() < 1e-2, "a uniform force of 10 m/s2 gives 20 m/s: {}", energy(&solver));
    let mut solver = still(100.0);
    assert!(matches!(solver.step(100.0, &[]), Err(StepError::TooLong { .. })));
    assert!(energy(&solver).is_finite());
}

/// A few sweeps from the potential of another flow add no energy, and periodic boxes with an odd number of cells converge.
#[test]
fn an_unconverged_projection_never_adds_energy() {
    for method in [
        IterativeMethod::Jacobi,
        IterativeMethod::GaussSeidel,
        IterativeMethod::Sor,
        IterativeMethod::ConjugateGradients,
        IterativeMethod::Multigrid,
    ] {
        let pressure = Pressure::Iterative(method, Effort { tolerance: 1e-12, sweeps: 1 });
        let mut solver = turbulent(Config { pressure, damping: 0.0, viscosity_m2_per_s: 0.0, ..Config::default() });
        solver.set_velocity(|[x, y, _]| [(0.7 * x).sin(), (1.1 * y).cos(), 0.0]);
        solver.set_velocity(|[x, _, z]| [0.0, (0.9 * x).sin() * 1e-2, (0.4 * z).cos() * 1e-2]);
        let start = energy(&solver);
        assert!(start <= 2.0 * 216.0 * 1e-4, "{method:?}: more than it was set to, {start}");
        for _ in 0..20 {
            solver.step(0.01, &[]).expect("a short step");
            assert!(energy(&solver) <= start * 1.001, "{method:?}: {} of {start}", energy(&solver));
        }
    }
    for cells in [[3, 18, 1], [1, 9, 28], [5, 5, 5], [3, 3, 3], [2, 12, 13]] {
        for method in [IterativeMethod::ConjugateGradients, IterativeMethod::Multigrid, IterativeMethod::Sor] {
            let pressure = Pressure::Iterative(method, Effort { tolerance: 1e-9, sweeps: 500 });
            let config = Config { pressure, boundary: [[Boundary::Wrap; 2]; 3], profile: Profile::Uniform, ..Config::default() };
            let mut solver = Solver::<f64>::new(&Config { cells, spacing_m: [1.0; 3], ..config }).expect("a legal box");
            solver.set_velocity(|[x, y, z]| [(x * x + y).sin(), (3.0 * z + x).cos(), (y * y - z).sin()]);
            let report = solver.step(0.01, &[]).expect("a short step");
            assert!(report.pressure_residual <= 1e-9, "{cells:?} {method:?}: {report:?}");
        }
    }
}
