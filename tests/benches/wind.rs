//! Time of a wind step by each method, and of each projection, compared with Zhang's.
//!
//! It also prints the memory bandwidth, the fraction of it that each step uses, the time of steps with something in the air relative to
//! those with nothing, and the remaining divergence of each projection.

use std::f32::consts::PI;
use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{BatchSize, BenchmarkGroup, BenchmarkId, Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use prairie_wind::pressure::{self, Effort, IterativeMethod, Projection};
use prairie_wind::stable_fluids::listing::SWEEPS;
use prairie_wind::{
    Advection, Air, Body, Boundary, Config, DragBody, Grid, Gusts, Location, Method, Pressure, Profile, Solver, StableFluids, TimeScheme,
    Velocity,
};
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

const DT_SECS: f64 = 1.0 / 60.0;
/// Untimed steps at the start, so that gusts have developed.
const STEPS_BEFORE: usize = 5;
/// Values in each array of the triad: 64 MiB, beyond any cache.
const TRIAD_LEN: usize = 1 << 24;
const TRIAD_RUNS: usize = 10;

/// A method of the benchmark, and the memory traffic of its step per cell.
struct Candidate {
    name: &'static str,
    method: Method,
    advection: Advection,
    time: TimeScheme,
    /// Each pass over the box reads every array it uses once and writes every result once; neighbours come from the cache. f32 except for the f64 of a
    /// direct pressure solve. Default settings: explicit diffusion, no dust, no canopy, relaxation to the mean wind along x and z.
    bytes_per_cell: usize,
}

/// Divergence 12 + 8, three passes of the transforms 3·16, gradient 3·(8 + 8).
const DIRECT_PROJECTION: usize = 20 + 48 + 48;
/// Relaxation of two components to the mean wind: sum 4, shift 8.
const MEAN_WIND: usize = 2 * 12;
/// Velocity interpolated to centres, four numbers each: 12 + 16; diagnostics 12.
const OBSERVATION: usize = 28 + 12;
/// Velocity to centres 28, trajectories backward and forward 16 + 2·16.
const TRACE: usize = 28 + 48;
/// Three components: the forward step with bounds 16 + 4 + 4 + 8, the step back 16 + 4 + 4 + 8 + 4.
const MACCORMACK: usize = 3 * (32 + 36);

const CANDIDATES: [Candidate; 4] = [
    Candidate {
        name: "conservative, Runge-Kutta 3",
        method: Method::Staggered,
        advection: Advection::Conservative,
        time: TimeScheme::RungeKutta3,
        // Stages of three components, each with the whole velocity, the pressure gradient and the result, the later two also with the start; update of
        // the pressure gradient.
        bytes_per_cell: 2 * MEAN_WIND + 3 * (20 + 24 + 24) + DIRECT_PROJECTION + 48 + OBSERVATION,
    },
    Candidate {
        name: "semi-Lagrangian, split",
        method: Method::Staggered,
        advection: Advection::SemiLagrangian,
        time: TimeScheme::Split,
        // Three components along the trajectories 16 + 4 + 4, diffusion 3·8.
        bytes_per_cell: TRACE + 3 * 24 + MEAN_WIND + 24 + DIRECT_PROJECTION + OBSERVATION,
    },
    Candidate {
        name: "MacCormack, reflection",
        method: Method::Staggered,
        advection: Advection::MacCormack,
        time: TimeScheme::Reflection,
        // Diffusion twice by midpoint 3·(8 + 12), a copy 3·8, the reflection 3·12.
        bytes_per_cell: 2 * (MEAN_WIND + 60 + TRACE) + 3 * (MACCORMACK + DIRECT_PROJECTION) + 24 + 36 + OBSERVATION,
    },
    Candidate {
        name: "stable fluids",
        method: Method::StableFluids,
        advection: Advection::SemiLagrangian,
        time: TimeScheme::Split,
        // The body force 3·8; diffusion of three components, a copy and 20 sweeps of 12; two projections, each with divergence 16, a zero initial guess
        // 4, 20 sweeps and the gradient 3·12; advection of three components 16; diagnostics 12 + 8.
        bytes_per_cell: MEAN_WIND + 24 + 3 * (8 + 20 * 12) + 2 * (16 + 4 + 20 * 12 + 36) + 3 * 16 + 20,
    },
];

fn threads(number: usize) -> ThreadPool {
    ThreadPoolBuilder::new().num_threads(number).build().expect("threads can be started")
}

/// Bandwidth (bytes/s) of `a = b + s·c`, counted as two reads and a write, in the fastest of some runs.
fn triad_bytes_per_s(pool: &ThreadPool) -> f64 {
    let (mut a, b, c) = (vec![0.0f32; TRIAD_LEN], vec![1.0f32; TRIAD_LEN], vec![2.0f32; TRIAD_LEN]);
    let chunk = TRIAD_LEN / 16;
    let mut run = || {
        let begun = Instant::now();
        pool.install(|| {
            a.par_chunks_mut(chunk).zip(b.par_chunks(chunk)).zip(c.par_chunks(chunk)).for_each(|((a, b), c)| {
                for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
                    *a = b + 3.0 * c;
                }
            });
        });
        black_box(&mut a);
        begun.elapsed()
    };
    let fastest = (0..TRIAD_RUNS).map(|_| run()).min().expect("there are runs");
    (3 * size_of::<f32>() * TRIAD_LEN) as f64 / fastest.as_secs_f64()
}

fn brief(group: &mut BenchmarkGroup<'_, criterion::measurement::WallTime>) {
    group.sample_size(10).sampling_mode(SamplingMode::Flat).nresamples(1000);
    group.warm_up_time(Duration::from_millis(100)).measurement_time(Duration::from_millis(300));
}

fn step(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("wind step");
    brief(&mut group);
    for number in [1, 2] {
        let pool = threads(number);
        let triad = triad_bytes_per_s(&pool);
        println!("triad on {number} threads: {:.1} GB/s", triad / 1e9);
        for cells in [[8, 8, 8], [16, 16, 16], [32, 8, 32], [32, 32, 32], [64, 32, 64], [64, 64, 64], [128, 32, 128]] {
            let [nx, ny, nz] = cells;
            group.throughput(Throughput::Elements((nx * ny * nz) as u64));
            // Zhang's method is single-threaded.
            for candidate in CANDIDATES.iter().filter(|candidate| number == 1 || candidate.method == Method::Staggered) {
                let config = Config { cells, advection: candidate.advection, time: candidate.time, ..Config::default() };
                let mut air = Air::<f32>::new(candidate.method, &config).expect("allowed settings");
                let mut fastest = Duration::MAX;
                let id = BenchmarkId::new(format!("{}, {number} threads", candidate.name), format!("{nx}x{ny}x{nz}"));
                group.bench_function(id, |bencher| {
                    pool.install(|| {
                        for _ in 0..STEPS_BEFORE {
                            air.step(DT_SECS, &[]).expect("a step within the limits");
                        }
                        bencher.iter(|| {
                            let begun = Instant::now();
                            black_box(air.step(DT_SECS, &[]).expect("a step within the limits"));
                            fastest = fastest.min(begun.elapsed());
                        });
                    });
                });
                if fastest < Duration::MAX {
                    let bytes_per_s = (candidate.bytes_per_cell * nx * ny * nz) as f64 / fastest.as_secs_f64();
                    let fraction = 100.0 * bytes_per_s / triad;
                    println!("{}: {} bytes per cell, {fraction:.0} % of the triad's bandwidth", candidate.name, candidate.bytes_per_cell);
                }
            }
        }
    }
    group.finish();
}

/// Something in the air: put there once, and moved before each step, whose number is given.
struct Obstacle {
    name: &'static str,
    put: fn(&mut Solver<f32>),
    advance: fn(&mut Solver<f32>, usize),
}

/// Land that rises to 4 m, over the whole length of a box of cells of 1 m.
fn immerse_land(air: &mut Solver<f32>) {
    let land_m = |x: f64, z: f64| 2.0 + 2.0 * (0.2 * x).sin() * (0.2 * z).cos();
    air.set_walls(|[x, y, z]| y - land_m(x, z), |_| [0.0; 3]).expect("land that leaves air");
}

/// A box of 5 m that the cells resolve, at 10 m/s along X.
fn advance_body(air: &mut Solver<f32>, step: usize) {
    let x_m = 8.0 + (step as f64 * 10.0 * DT_SECS) % 16.0;
    let body = Body {
        centre_m: [x_m, 2.5, 16.0],
        half_extents_m: [2.5; 3],
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        velocity_m_per_s: [10.0, 0.0, 0.0],
        drag_coefficient: 1.0,
    };
    air.set_bodies(&[body]).expect("bodies of finite size");
}

const CROWN_DRAG_PER_M: f64 = 0.3;

/// A wood: a crown of 50 m³, 4 m across from 2 to 6 m above the ground, every 8 m.
fn plant_crowns(air: &mut Solver<f32>) {
    let [columns, _, rows] = air.grid().cells;
    let places = (0..columns / 8).flat_map(|i| (0..rows / 8).map(move |k| [i, k].map(|n| 4.0 + 8.0 * n as f64)));
    let crowns: Vec<_> = places
        .map(|[x, z]| DragBody {
            centre_m: [x, 4.0, z],
            half_extents_m: [2.0; 3],
            velocity_m_per_s: [0.0; 3],
            drag_m2: [CROWN_DRAG_PER_M * 50.0; 3],
        })
        .collect();
    air.set_drag(&crowns).expect("bodies of finite size");
}

const OBSTACLES: [Obstacle; 4] = [
    Obstacle { name: "nothing", put: |_| (), advance: |_, _| () },
    Obstacle { name: "land", put: immerse_land, advance: |_, _| () },
    Obstacle { name: "moving body", put: |_| (), advance: advance_body },
    Obstacle { name: "crowns", put: plant_crowns, advance: |_, _| () },
];

/// Steps with something in the air beside those with nothing, by default settings.
fn solids(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("wind solids");
    brief(&mut group);
    let pool = threads(1);
    for cells in [[32, 8, 32], [64, 32, 64]] {
        let [nx, ny, nz] = cells;
        group.throughput(Throughput::Elements((nx * ny * nz) as u64));
        let mut fastest = [Duration::MAX; OBSTACLES.len()];
        for (Obstacle { name, put, advance }, fastest) in OBSTACLES.iter().zip(&mut fastest) {
            let config = Config { cells, spacing_m: [1.0; 3], ..Config::default() };
            let mut air = Solver::<f32>::new(&config).expect("allowed settings");
            put(&mut air);
            let mut steps = 0;
            let mut step = |air: &mut Solver<f32>| {
                steps += 1;
                advance(air, steps);
                black_box(air.step(DT_SECS, &[]).expect("a step within the limits"));
            };
            group.bench_function(BenchmarkId::new(*name, format!("{nx}x{ny}x{nz}")), |bencher| {
                pool.install(|| {
                    (0..STEPS_BEFORE).for_each(|_| step(&mut air));
                    bencher.iter(|| {
                        let begun = Instant::now();
                        step(&mut air);
                        *fastest = (*fastest).min(begun.elapsed());
                    });
                });
            });
        }
        for (Obstacle { name, .. }, with) in OBSTACLES.iter().zip(fastest).skip(1).filter(|_| fastest[0] < Duration::MAX) {
            println!("{nx}x{ny}x{nz} with {name}: {:.2} times the step with nothing", with.as_secs_f64() / fastest[0].as_secs_f64());
        }
    }
    group.finish();
}

/// A smooth gradient field, which a projection should remove completely.
fn smooth([x, y, z]: [f32; 3], n: usize) -> [f32; 3] {
    let k = PI / n as f32;
    [(k * x).sin() * (k * y).cos(), (k * x).cos() * (k * y).sin() + (2.0 * k * y).sin(), (3.0 * k * z).sin()]
}

/// Root mean square of the divergence that a projection of `velocity` leaves, relative to that before.
fn fraction_left(grid: &Grid<f32>, velocity: &Velocity<f32>, projection: &mut Projection) -> f64 {
    let rms = |velocity: &Velocity<f32>| {
        let mut divergence = vec![0.0; grid.len()];
        pressure::divergence(grid, velocity, 1.0, &mut divergence);
        divergence.iter().map(|rate| rate * rate).sum::<f64>().sqrt()
    };
    let mut projected = velocity.clone();
    projection.project(grid, &mut projected, &[], None);
    rms(&projected) / rms(velocity)
}

fn projection(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("wind projection");
    brief(&mut group);
    let pool = threads(1);
    let effort = Effort { tolerance: 1e-5, sweeps: 100_000 };
    let methods = [
        IterativeMethod::Multigrid,
        IterativeMethod::ConjugateGradients,
        IterativeMethod::Sor,
        IterativeMethod::GaussSeidel,
        IterativeMethod::Jacobi,
    ];
    for n in [8, 16, 32, 64] {
        group.throughput(Throughput::Elements((n * n * n) as u64));
        let grid = Grid { cells: [n; 3], spacing_m: [1.0f32; 3], boundary: [[Boundary::FreeSlip; 2]; 3] };
        // Zero on every face of the box, as at walls.
        let mut velocity = Velocity::zeros(&grid);
        for (axis, field) in velocity.0.iter_mut().enumerate() {
            field.fill(&grid, |position| smooth(position, n)[axis]);
            debug_assert_eq!(field.location, Location::Face(axis));
        }
        // Methods that need n² sweeps take seconds at 32³.
        let slow = |method: &IterativeMethod| matches!(method, IterativeMethod::GaussSeidel | IterativeMethod::Jacobi);
        let iterative = methods.into_iter().filter(|method| n <= 16 || !slow(method)).map(|method| Pressure::Iterative(method, effort));
        for pressure in std::iter::once(Pressure::Direct).chain(iterative) {
            let name = match pressure {
                Pressure::Direct => "Direct".to_owned(),
                Pressure::Iterative(method, _) => format!("{method:?} to 1e-5"),
            };
            let left = fraction_left(&grid, &velocity, &mut Projection::new(&grid, pressure, None));
            println!("{name} at {n}³ leaves {left:.1e} of the divergence");
            // Created anew each time: an iteration starts from the previous potential.
            let fresh = || (Projection::new(&grid, pressure, None), velocity.clone());
            group.bench_function(BenchmarkId::new(name, n), |bencher| {
                pool.install(|| {
                    let project = |(projection, velocity): &mut (Projection, _)| projection.project(&grid, velocity, &[], None);
                    bencher.iter_batched_ref(fresh, project, BatchSize::PerIteration);
                });
            });
        }

        let config = Config {
            cells: [n; 3],
            spacing_m: [1.0; 3],
            boundary: [[Boundary::Reflect; 2]; 3],
            mean_wind_m_per_s: [0.0; 3],
            profile: Profile::Uniform,
            gusts: Gusts { number: 0, ..Gusts::default() },
            ..Config::default()
        };
        let mut air = StableFluids::<f32>::new(&config).expect("allowed settings");
        air.set_velocity(|position| smooth(position, n));
        let rms = |air: &StableFluids<f32>| {
            let diagnostics = air.diagnostics();
            diagnostics.divergence_rms_rel * diagnostics.kinetic_energy_m2_per_s2.sqrt()
        };
        let before = rms(&air);
        air.project(SWEEPS);
        println!("{SWEEPS} Gauss-Seidel sweeps at {n}³ leave {:.1e} of the divergence", rms(&air) / before);
        group.bench_function(BenchmarkId::new("Zhang: 20 Gauss-Seidel sweeps", n), |bencher| {
            bencher.iter(|| air.project(black_box(SWEEPS)))
        });
    }
    group.finish();
}

criterion_group!(benches, step, solids, projection);
criterion_main!(benches);
