//! No step allocates memory, save for work arrays that the first steps still enlarge.

use glam::Vec3;
use prairie_wind::intensity::Spline;
use prairie_wind::pressure::{Effort, IterativeMethod};
use prairie_wind::{
    Advection, Body, Boundary, Canopy, CanopyMotion, Config, Diffusion, Dust, Front, Gusts, Intensity, Jet, Pressure, Primitive, Profile,
    Real, Shape, Solver, StableFluids, TimeScheme,
};

/// Steps before the count starts, in which work arrays may still grow to their final size.
const WARM_UP_STEPS: usize = 2;
const STEPS: usize = 3;
const DT_SECS: f64 = 0.1;

/// Allocations by steps of a solver after its first ones. They are counted on one thread, so that has to be the only one that works.
fn allocations<R: Real>(config: &Config) -> u64 {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| {
        let mut air = Solver::<R>::new(config).unwrap_or_else(|error| panic!("{error}: {config:?}"));
        air.set_canopy_fraction(std::iter::repeat_n(0.7, config.cells[0] * config.cells[2]));
        let jets = [Jet { position_m: Vec3::splat(9.0), radius_m: 3.0, velocity_m_per_s: Vec3::NEG_Y * 6.0, rate_per_s: 2.0 }];
        let mut step = |_| {
            air.step(DT_SECS, &jets).unwrap_or_else(|error| panic!("{error}: {config:?}"));
        };
        (0..WARM_UP_STEPS).for_each(&mut step);
        allocation_counter::measure(|| (0..STEPS).for_each(&mut step)).count_total
    })
}

/// Gusty air with everything that acts on it. Gusts live for less time than is counted, so some are reborn.
fn everything() -> Config {
    let primitive = |shape| Primitive {
        shape,
        position_m: [8.0, 4.0, 8.0],
        drift_m_per_s: [1.0, 0.0],
        radius_m: 6.0,
        speed_m_per_s: 3.0,
        direction: [1.0, 0.0],
        dust: 1.0,
        intensity: Intensity::Spline(Spline::new(0.5, vec![[0.0, 0.0], [0.1, 1.0]])),
        front: Front { speed_m_per_s: 30.0, step_m: 0.5 },
    };
    Config {
        cells: [9, 8, 10],
        spacing_m: [2.0, 1.0, 2.0],
        gusts: Gusts { number: 5, life_secs: 0.25, radius_m: [4.0; 3], ..Gusts::default() },
        primitives: [Shape::Uniform, Shape::Source, Shape::Sink, Shape::Vortex, Shape::Cyclone].map(primitive).to_vec(),
        canopy: Some(Canopy::default()),
        dust: Some(Dust::default()),
        ..Config::default()
    }
}

#[test]
fn no_scheme_allocates_in_a_step() {
    let diffusions = [Diffusion::Explicit, Diffusion::GaussSeidel { sweeps: 3 }, Diffusion::Implicit, Diffusion::CrankNicolson];
    for &advection in Advection::ALL {
        for &time in TimeScheme::ALL.iter().filter(|time| time.allows(advection)) {
            for diffusion in diffusions {
                let dust = Some(Dust { advection, ..Dust::default() });
                let config = Config { advection, time, diffusion, dust, ..everything() };
                assert_eq!([allocations::<f32>(&config), allocations::<f64>(&config)], [0; 2], "{advection:?} {time:?} {diffusion:?}");
            }
        }
    }
}

#[test]
fn no_pressure_solver_allocates_in_a_step() {
    let effort = Effort { tolerance: 1e-3, sweeps: 20 };
    let methods = [
        IterativeMethod::Jacobi,
        IterativeMethod::GaussSeidel,
        IterativeMethod::Sor,
        IterativeMethod::ConjugateGradients,
        IterativeMethod::Multigrid,
    ]
    .map(|method| Pressure::Iterative(method, effort));
    for pressure in methods.into_iter().chain([Pressure::Direct]) {
        assert_eq!(allocations::<f32>(&Config { pressure, ..everything() }), 0, "{pressure:?}");
    }
}

#[test]
fn no_boundary_condition_allocates_in_a_step() {
    for face in Boundary::all([1.0, 0.0, 0.0]) {
        let boundary = [[Boundary::Wrap; 2], [Boundary::FreeSlip; 2], [face; 2]];
        let config = Config { boundary, mean_wind_m_per_s: [3.0, 0.0, 0.0], profile: Profile::Uniform, ..everything() };
        assert_eq!(allocations::<f32>(&config), 0, "{face:?}");
    }
}

#[test]
fn a_grid_large_enough_for_parallel_loops_is_stepped_without_allocations() {
    assert_eq!(allocations::<f32>(&Config { cells: [48, 24, 48], ..everything() }), 0);
    let canopy = Some(Canopy { motion: Some(CanopyMotion::default()), ..Canopy::default() });
    assert_eq!(allocations::<f32>(&Config { canopy, ..everything() }), 0, "a canopy that moves");
}

/// A moving cube.
fn body(x_m: f64, half_m: f64) -> Body {
    Body {
        centre_m: [x_m, 7.0, 20.0],
        half_extents_m: [half_m; 3],
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        velocity_m_per_s: [1.0, 0.0, 0.0],
        drag_coefficient: 1.0,
    }
}

#[test]
fn solids_do_not_allocate_in_a_step() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let allocations = pool.install(|| {
        let mut air = Solver::<f32>::new(&Config { cells: [24, 12, 24], ..everything() }).unwrap();
        air.set_walls(|[x, y, _]| y - 0.1 * x, |_| [0.0; 3]).unwrap();
        let bodies = [body(20.0, 4.0), body(30.0, 0.4)];
        air.set_drag(&[bodies[1].drag()]).unwrap();
        let mut step = |_| {
            air.set_bodies(&bodies).unwrap();
            air.step(DT_SECS, &[]).unwrap();
        };
        (0..WARM_UP_STEPS).for_each(&mut step);
        allocation_counter::measure(|| (0..STEPS).for_each(&mut step)).count_total
    });
    assert_eq!(allocations, 0);
}

/// Growth of the stated memory (bytes) of a solver by a change of its solids, and that of the memory it holds.
fn growth<R: Real>(air: &mut Solver<R>, change: impl FnOnce(&mut Solver<R>)) -> [i64; 2] {
    let before = air.memory_bytes() as i64;
    let held = allocation_counter::measure(|| change(air)).bytes_current;
    [air.memory_bytes() as i64 - before, held]
}

fn check_memory_of_solids<R: Real>() {
    let mut air = Solver::<R>::new(&Config { cells: [24, 12, 24], ..everything() }).unwrap();
    let mut check = |name: &str, is_larger: bool, change: &dyn Fn(&mut Solver<R>)| {
        let [stated, held] = growth(&mut air, change);
        assert!(stated == held && (held > 0) == is_larger, "{name}: {stated} B more are stated, {held} B are held");
    };
    check("walls", true, &|air| air.set_walls(|[x, y, _]| y - 0.1 * x, |_| [0.0; 3]).unwrap());
    check("fixed drag", true, &|air| air.set_drag(&[body(30.0, 0.4).drag()]).unwrap());
    check("a small body", true, &|air| air.set_bodies(&[body(12.0, 0.4)]).unwrap());
    check("a large body", true, &|air| air.set_bodies(&[body(20.0, 4.0), body(12.0, 0.4)]).unwrap());
    check("no body", false, &|air| air.set_bodies(&[]).unwrap());
    check("no walls", false, &|air| air.set_walls(|_| 1.0, |_| [0.0; 3]).unwrap());
}

#[test]
fn the_stated_memory_includes_that_of_solids() {
    check_memory_of_solids::<f32>();
    check_memory_of_solids::<f64>();
}

/// A single solid cell takes a flag per cell and a list of its six faces.
#[test]
fn the_stated_memory_includes_that_of_solid_cells_and_inflow() {
    let effort = Effort { tolerance: 1e-3, sweeps: 20 };
    let config = Config { pressure: Pressure::Iterative(IterativeMethod::Multigrid, effort), ..everything() };
    let mut air = Solver::<f32>::new(&config).unwrap();
    let [stated, _] = growth(&mut air, |air| air.set_solid(|[x, y, z]| x == 5.0 && y == 2.5 && z == 5.0).unwrap());
    let [flags, faces] = [air.grid().len() as i64, (6 * size_of::<usize>()) as i64];
    assert!((flags + faces..=flags + 4 * faces).contains(&stated), "{stated} B for {flags} cells and a list of {faces} B");

    let between = |face: Boundary| {
        let boundary = [[Boundary::Wrap; 2], [Boundary::FreeSlip; 2], [face; 2]];
        let config = Config { boundary, mean_wind_m_per_s: [3.0, 0.0, 0.0], profile: Profile::Uniform, ..everything() };
        let air = Solver::<f32>::new(&config).unwrap();
        let [nx, ny, _] = air.grid().padded();
        (air.memory_bytes(), 3 * nx * ny * size_of::<f32>())
    };
    let ((closed, _), (open, per_face)) = (between(Boundary::NoSlip), between(Boundary::Inflow));
    assert_eq!(open - closed, 2 * per_face);
}

#[test]
fn stable_fluids_do_not_allocate_in_a_step() {
    let mut air = StableFluids::<f32>::new(&Config { canopy: None, ..everything() }).unwrap();
    let mut step = |_| {
        air.step(DT_SECS, &[]).unwrap();
    };
    (0..WARM_UP_STEPS).for_each(&mut step);
    assert_eq!(allocation_counter::measure(|| (0..STEPS).for_each(&mut step)).count_total, 0);
}

#[test]
fn an_allocation_in_a_step_would_be_counted() {
    let step = || drop(std::hint::black_box(vec![0.0_f32; 8]));
    assert_eq!(allocation_counter::measure(|| (0..STEPS).for_each(|_| step())).count_total, STEPS as u64);
}
