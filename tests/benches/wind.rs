//! Time of a step of the wind, and of its projection beside the one of 000.
//!
//! Printed beside the times: what the sweeps of 000 leave of the divergence.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use server::wind::pressure::Projection;
use server::wind::{Advection, Boundary, Config, Grid, Velocity, WindSolver};
use tests::gauss_seidel::GaussSeidelProjection;

fn step(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("wind step");
    for cells in [[8, 8, 8], [32, 8, 32], [64, 32, 64]] {
        let [nx, ny, nz] = cells;
        group.throughput(Throughput::Elements((nx * ny * nz) as u64));
        for advection in [Advection::SemiLagrangian, Advection::MacCormack] {
            let mut wind = WindSolver::new(&Config { cells, advection, ..Config::default() }).unwrap();
            group.bench_function(BenchmarkId::new(format!("{advection:?}"), format!("{nx}x{ny}x{nz}")), |bencher| {
                bencher.iter(|| black_box(wind.step(1.0 / 60.0, &[]).unwrap()));
            });
        }
    }
    group.finish();
}

fn projection(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("wind projection");
    for n in [8, 16, 32, 64] {
        group.throughput(Throughput::Elements((n * n * n) as u64));
        let grid = Grid { cells: [n; 3], spacing_m: [1.0f32; 3], boundary: [Boundary::Wall; 3] };
        let mut velocity = Velocity::zeros(&grid);
        let smooth = |x: f32| (std::f32::consts::PI * x / n as f32).sin();
        velocity.0[0].fill(&grid, |[x, ..]| smooth(x));
        let mut direct = Projection::new(&grid);
        group.bench_function(BenchmarkId::new("direct", n), |bencher| bencher.iter(|| direct.project(&grid, black_box(&mut velocity))));

        let mut sweeps = GaussSeidelProjection::new(n);
        let still = vec![0.0; (n + 2usize).pow(3)];
        let mut collocated = [still.clone(), still.clone(), still];
        for k in 1..=n {
            for j in 1..=n {
                for i in 1..=n {
                    collocated[0][sweeps.index(i, j, k)] = smooth(i as f32 - 0.5);
                }
            }
        }
        let before = sweeps.divergence_rms(&collocated);
        let mut projected = collocated.clone();
        sweeps.project(&mut projected);
        println!("20 Gauss-Seidel sweeps at {n}^3 leave {:.0} % of the divergence", 100.0 * sweeps.divergence_rms(&projected) / before);
        group.bench_function(BenchmarkId::new("20 Gauss-Seidel sweeps", n), |bencher| {
            bencher.iter(|| sweeps.project(black_box(&mut collocated)));
        });
    }
    group.finish();
}

criterion_group!(benches, step, projection);
criterion_main!(benches);
