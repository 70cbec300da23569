use super::super::Boundary::{self, *};
use super::super::boundary::BoundaryConditions;
use super::*;

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
}

fn walls<R: Real>(grid: &Grid<R>) -> BoundaryConditions<R> {
    BoundaryConditions::new(grid, Box::new(|_, _| [0.0; 3]))
}

/// A velocity with divergence at every scale: smooth waves of the length of the box, and noise.
fn divergent(grid: &Grid<f32>, noise: f32) -> Velocity<f32> {
    let mut velocity = Velocity::zeros(grid);
    let mut seed = 1u32;
    for (axis, field) in velocity.0.iter_mut().enumerate() {
        let extent = grid.extent_m(axis);
        field.fill(grid, |position| (std::f32::consts::TAU * position[axis] / extent).sin() * extent);
        for row in field.rows(grid) {
            for value in &mut field.data[row..][..field.shape[0]] {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                *value += noise * (seed as f32 / u32::MAX as f32 - 0.5);
            }
        }
    }
    walls(grid).apply(&mut velocity);
    velocity
}

fn left_over(cells: [usize; 3], spacing_m: [f32; 3], boundary: [[Boundary; 2]; 3], noise: f32) -> f64 {
    let grid = Grid { cells, spacing_m, boundary };
    let mut velocity = divergent(&grid, noise);
    let (mut before, mut after) = (vec![0.0; grid.len()], vec![0.0; grid.len()]);
    divergence(&grid, &velocity, 1.0, &mut before);
    Projection::new(&grid, Pressure::Direct, None).project(&grid, &mut velocity, &[], None);
    walls(&grid).apply(&mut velocity);
    divergence(&grid, &velocity, 1.0, &mut after);
    rms(&after) / rms(&before)
}

#[test]
fn projection_leaves_no_divergence() {
    let shapes = [
        ([8, 8, 8], [1.0; 3]),
        ([16, 16, 16], [0.5; 3]),
        ([32, 32, 32], [1.0; 3]),
        ([64, 64, 64], [1.0; 3]),
        ([32, 8, 32], [8.0, 2.0, 8.0]),
        ([64, 32, 64], [4.0, 1.0, 2.0]),
        ([12, 7, 30], [1.0, 3.0, 0.7]),
        ([1, 5, 9], [1.0; 3]),
    ];
    for (cells, spacing) in shapes {
        let (wrap, slip, open) = ([Wrap; 2], [FreeSlip; 2], [NoSlip, Outflow]);
        for boundary in [[wrap; 3], [slip; 3], [wrap, slip, wrap], [slip, wrap, slip], [open, wrap, slip], [open, open, [Outflow; 2]]] {
            for noise in [0.0, 100.0] {
                let left = left_over(cells, spacing, boundary, noise);
                println!("{cells:?} {boundary:?} noise {noise}: {left:.1e}");
                assert!(left <= 1e-6, "{cells:?} {boundary:?} noise {noise}: {left:e} of the divergence is left");
            }
        }
    }
}

#[test]
fn projection_keeps_momentum_across_wraps() {
    let grid = Grid { cells: [16, 12, 20], spacing_m: [1.0, 2.0, 0.5], boundary: [[Wrap; 2]; 3] };
    let mut velocity = divergent(&grid, 10.0);
    let momentum = |velocity: &Velocity<f32>| velocity.0.each_ref().map(|field| field.values(&grid).map(f64::from).sum::<f64>());
    let before = momentum(&velocity);
    Projection::new(&grid, Pressure::Direct, None).project(&grid, &mut velocity, &[], None);
    let size: f64 = velocity.0.iter().flat_map(|field| field.values(&grid)).map(|x| f64::from(x.abs())).sum();
    for (before, after) in before.into_iter().zip(momentum(&velocity)) {
        assert!((after - before).abs() <= 1e-7 * size, "{before} became {after}, of {size}");
    }
}

#[test]
fn projecting_twice_changes_nothing_more() {
    let grid = Grid { cells: [12, 6, 10], spacing_m: [1.0, 2.0, 0.5], boundary: [[Wrap; 2], [FreeSlip, Outflow], [NoSlip; 2]] };
    let (mut once, mut projection) = (Velocity::zeros(&grid), Projection::new(&grid, Pressure::Direct, None));
    for (axis, field) in once.0.iter_mut().enumerate() {
        field.fill(&grid, |[x, y, z]| (x * 1.3 + axis as f64).sin() + y * z);
    }
    walls(&grid).apply(&mut once);
    projection.project(&grid, &mut once, &[], None);
    walls(&grid).apply(&mut once);
    let mut twice = once.clone();
    projection.project(&grid, &mut twice, &[], None);
    for (a, b) in once.0.iter().zip(&twice.0) {
        assert!(a.values(&grid).zip(b.values(&grid)).all(|(a, b)| (a - b).abs() < 1e-12));
    }
}

#[test]
fn every_solver_leaves_the_divergence_it_reports() {
    let grid = Grid { cells: [12, 8, 10], spacing_m: [1.0f32, 2.0, 0.5], boundary: [[Wrap; 2], [FreeSlip; 2], [NoSlip, Outflow]] };
    for method in [
        IterativeMethod::Jacobi,
        IterativeMethod::GaussSeidel,
        IterativeMethod::Sor,
        IterativeMethod::ConjugateGradients,
        IterativeMethod::Multigrid,
    ] {
        let mut velocity = divergent(&grid, 10.0);
        let (mut before, mut after) = (vec![0.0; grid.len()], vec![0.0; grid.len()]);
        divergence(&grid, &velocity, 1.0, &mut before);
        let pressure = Pressure::Iterative(method, Effort { tolerance: 1e-5, sweeps: 2000 });
        let convergence = Projection::new(&grid, pressure, None).project(&grid, &mut velocity, &[], None);
        walls(&grid).apply(&mut velocity);
        divergence(&grid, &velocity, 1.0, &mut after);
        let left = rms(&after) / rms(&before);
        println!("{method:?}: {left:.1e} after {} sweeps, said {:.1e}", convergence.sweeps, convergence.residual);
        assert!(convergence.met() && left < 1.2e-5, "{method:?} leaves {left:e}, says {convergence:?}");
    }
}
