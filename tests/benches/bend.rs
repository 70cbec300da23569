//! Benchmark of the bend field alone: cell-steps per second of every scheme on 1, 25 and 225 awake patches of 120 × 120 cells, on one thread and on
//! two; one patch with a twentieth of its cells moving; and the patch that repeats far from cameras in the natural wind.
//!
//! For comparison it prints the memory bandwidth: a sub-step reads both states and writes one, 36 bytes per cell; further sub-steps of a patch find
//! them in the cache. The fastest of several steps counts.

use std::hint::black_box;
use std::time::{Duration, Instant};

use prairie::bend::pool::Pool;
use prairie_core::bend::{Bend, Field, HALO, Kinds, Report, Rest, Scheme, TILE, WaveParams};
use prairie_core::grass::RepeatedPatch;
use prairie_core::grid::PatchLayout;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

const CELLS: u32 = 120;
const CELL_M: f32 = 0.4572;
/// Three channels, two states read, one written.
const BYTES_PER_CELL: f64 = 36.0;
/// Values in each array of the triad: 64 MiB, beyond any cache.
const TRIAD_LEN: usize = 1 << 24;
const TRIAD_RUNS: usize = 10;
/// Timing duration of a case, after its minimum number of steps.
const ENOUGH: Duration = Duration::from_millis(400);
const FEWEST_STEPS: u32 = 4;

/// Grass whose wave speed follows the bend, so that every term is exercised; weakly damped, so that it moves to the end.
const GRASS: WaveParams = WaveParams {
    c0_m_per_s: 2.0,
    mu_m_per_rad: 0.05,
    c_omega_m_per_s: 2.0,
    theta_damping_per_s: 0.1,
    omega_damping_per_s: 0.1,
    stiffness_per_s2: 1.2,
};

fn pool(threads: usize) -> ThreadPool {
    ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started")
}

/// Bandwidth (bytes/s) of `a = b + s·c` over three arrays, two read and one written.
fn triad_bytes_per_s() -> f64 {
    let (b, c) = (vec![1.0f32; TRIAD_LEN], vec![2.0f32; TRIAD_LEN]);
    let mut a = vec![0.0f32; TRIAD_LEN];
    let run = |a: &mut Vec<f32>| {
        let begun = Instant::now();
        a.par_chunks_mut(1 << 16)
            .zip(b.par_chunks(1 << 16).zip(c.par_chunks(1 << 16)))
            .for_each(|(a, (b, c))| a.iter_mut().zip(b.iter().zip(c)).for_each(|(a, (b, c))| *a = b + 0.5 * c));
        black_box(a);
        begun.elapsed().as_secs_f64()
    };
    let best = (0..TRIAD_RUNS).map(|_| run(&mut a)).fold(f64::INFINITY, f64::min);
    3.0 * (TRIAD_LEN * size_of::<f32>()) as f64 / best
}

/// A square of patches in which every cell moves.
fn moving(side: u32, waves: WaveParams) -> Field {
    let mut field = Field::new(PatchLayout { count: [side; 2], cells: CELLS, cell_m: CELL_M }, Kinds::one(waves));
    field.start(0.01, |[x, z]| {
        let [theta, u, w] = [0.7, 1.3, 2.1].map(|pitch: f32| 0.3 * (pitch * x).sin() * (0.9 * pitch * z).cos());
        [Bend { theta, omega: [u, w] }; 2]
    });
    field
}

/// A scheme and its number of sub-steps per step.
#[derive(Clone, Copy)]
struct Case {
    scheme: Scheme,
    substeps: u32,
}

impl Case {
    fn dt_secs(self, field: &Field) -> f32 {
        // The sub-stepped scheme stays 5 % below the limit, 50 % where the speed of θ varies; a step a little shorter still is split into the required number.
        let is_split = self.scheme == Scheme::Substepped && field.kinds().waves()[0].mu_m_per_rad > 0.0;
        (if is_split { 0.48 } else { 0.93 }) * f32::from(self.substeps as u16) * field.stable_dt_secs(self.scheme)
    }

    /// Shortest time of a step (s), and the report of the last one.
    fn time(self, field: &mut Field) -> (f64, Report) {
        let (dt_secs, begun) = (self.dt_secs(field), Instant::now());
        let (mut best, mut last, mut steps) = (f64::INFINITY, Report::default(), 0);
        while steps < FEWEST_STEPS || begun.elapsed() < ENOUGH {
            let step = Instant::now();
            last = field.step(self.scheme, dt_secs, &Pool).expect("the whole field is awake, and its speed constant where it must be");
            best = best.min(step.elapsed().as_secs_f64());
            steps += 1;
        }
        (best, last)
    }
}

fn main() {
    // `cargo test` and `--test` run each benchmark once; this one is skipped.
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    let pools = [1, 2].map(|threads| (threads, pool(threads)));
    let bandwidth = pools.each_ref().map(|(threads, pool)| {
        let bytes_per_s = pool.install(triad_bytes_per_s);
        println!("triad, {threads} thread{}: {:.1} GB/s", if *threads == 1 { "" } else { "s" }, bytes_per_s * 1e-9);
        bytes_per_s
    });
    println!("\n| patches | scheme                  | threads | ms a step | 1e9 cell-steps/s | GB/s | of the triad |");
    println!("| ------: | ----------------------- | ------: | --------: | ---------------: | ---: | -----------: |");
    let explicit = [(Scheme::Verlet, 1), (Scheme::Substepped, 1), (Scheme::Substepped, 2), (Scheme::Substepped, 4), (Scheme::Implicit, 1)];
    for side in [1, 5, 15] {
        let schemes = explicit.into_iter().chain((side < 15).then_some((Scheme::Modal, 1)));
        for (scheme, substeps) in schemes {
            let mu_m_per_rad = if scheme == Scheme::Modal { 0.0 } else { GRASS.mu_m_per_rad };
            let mut field = moving(side, WaveParams { mu_m_per_rad, ..GRASS });
            for ((threads, pool), bandwidth) in pools.iter().zip(bandwidth) {
                let (secs, report) = pool.install(|| Case { scheme, substeps }.time(&mut field));
                assert_eq!((report.substeps, report.reset_patches), (substeps, 0));
                let cells = f64::from(side * side * CELLS * CELLS);
                let rate = cells * f64::from(substeps) / secs;
                let passes = f64::from(substeps.div_ceil(HALO as u32));
                let traffic = cells * passes * BYTES_PER_CELL / secs;
                let name = format!("{scheme:?}, {substeps} sub-step{}", if substeps == 1 { "" } else { "s" });
                println!(
                    "| {:>7} | {name:<23} | {threads:>7} | {:>9.3} | {:>16.3} | {:>4.1} | {:>10.0} % |",
                    side * side,
                    secs * 1e3,
                    rate * 1e-9,
                    traffic * 1e-9,
                    100.0 * traffic / bandwidth
                );
            }
        }
    }
    few_tiles(&pools[0].1);
    repeated_patch();
}

/// A step of the repeated patch of gusts of noise, which is done 30 times a second.
fn repeated_patch() {
    const STEPS: u64 = 300;
    let mut loaded = prairie::scenes::load("breeze").expect("a built-in scene");
    loaded.scene.tick_hz = 30.0;
    let mut patch = RepeatedPatch::new(&loaded.scene).expect("a scene with natural wind");
    let settled = 3000;
    patch.advance_to(settled, u32::MAX);
    let mut best_secs = f64::INFINITY;
    for run in 1..=5 {
        let begun = Instant::now();
        black_box(patch.advance_to(settled + run * STEPS, u32::MAX));
        best_secs = best_secs.min(begun.elapsed().as_secs_f64() / STEPS as f64);
    }
    let (cells, share) = (RepeatedPatch::cells(), best_secs * 30.0);
    println!("repeated patch of {cells} × {cells} cells, one thread: {:.3} ms a step, {:.2} % of a core", 1e3 * best_secs, 1e2 * share);
}

/// A patch with two adjacent moving tiles, for which twelve are stepped; nothing spreads.
fn few_tiles(pool: &ThreadPool) {
    let still = WaveParams {
        c0_m_per_s: 0.0,
        mu_m_per_rad: 0.0,
        c_omega_m_per_s: 0.0,
        theta_damping_per_s: 0.0,
        omega_damping_per_s: 0.0,
        stiffness_per_s2: 0.0,
    };
    let layout = PatchLayout { count: [1, 1], cells: CELLS, cell_m: CELL_M };
    let time = |pressed: &dyn Fn(usize, usize) -> bool| {
        let mut field = Field::new(layout, Kinds::one(still)).with_rest(Rest { theta_rad: 0.01, omega_rad_per_s: 0.2 });
        let patch = field.wake(0);
        let tiles = CELLS as usize / TILE;
        for (x, z) in (0..tiles * tiles).map(|n| (n % tiles, n / tiles)).filter(|(x, z)| pressed(*x, *z)) {
            patch.press(x * TILE + 3, z * TILE + 3, Bend { theta: 0.5, omega: [1.0, 0.0] });
        }
        let (mut best, begun) = (f64::INFINITY, Instant::now());
        while begun.elapsed() < ENOUGH {
            let step = Instant::now();
            field.step(Scheme::Substepped, 1.0 / 60.0, &Pool).expect("one sub-step is enough at rest");
            best = best.min(step.elapsed().as_secs_f64());
        }
        best * 1e6
    };
    let (few, all) = pool.install(|| (time(&|x, z| (7..9).contains(&x) && z == 7), time(&|_, _| true)));
    println!(
        "\none patch of 225 tiles: {all:.1} µs a step where all move, {few:.1} µs where 12 step ({:.1} % of the time for 5.3 % of the tiles)",
        100.0 * few / all
    );
}
