//! Direct projection leaves no divergence beyond rounding; iterative solvers meet their tolerance; inflow equals outflow.

use std::f64::consts::TAU;

use prairie_charts::air::{noise, still_air};
use prairie_wind::pressure::{Effort, IterativeMethod, Projection, divergence};
use prairie_wind::{Boundary, Config, Grid, Pressure, Solver, Velocity, boundary::BoundaryConditions};

const WRAP: [[Boundary; 2]; 3] = [[Boundary::Wrap; 2]; 3];
const CLOSED: [[Boundary; 2]; 3] = [[Boundary::NoSlip; 2], [Boundary::NoSlip, Boundary::FreeSlip], [Boundary::Reflect; 2]];
const OPEN: [[Boundary; 2]; 3] = [[Boundary::Inflow, Boundary::Outflow], [Boundary::FreeSlip, Boundary::Outflow], [Boundary::Wrap; 2]];

/// Remaining rms divergence of the default projection in single precision, relative to that before.
fn left(cells: [usize; 3], boundary: [[Boundary; 2]; 3], flow: impl Fn([f32; 3], usize) -> f32) -> f64 {
    let grid = Grid { cells, spacing_m: [2.0, 1.0, 1.5], boundary };
    let walls = BoundaryConditions::new(&grid, Box::new(|_, _| [1.0, 0.0, 0.0]));
    let mut velocity = Velocity::zeros(&grid);
    for (axis, field) in velocity.0.iter_mut().enumerate() {
        field.fill(&grid, |position| flow(position, axis));
    }
    walls.apply(&mut velocity);
    let rms = |velocity: &Velocity<f32>| {
        let mut per_cell = vec![0.0; grid.len()];
        divergence(&grid, velocity, 1.0, &mut per_cell);
        (per_cell.iter().map(|d| d * d).sum::<f64>() / grid.len() as f64).sqrt()
    };
    let before = rms(&velocity);
    Projection::new(&grid, Pressure::default(), None).project(&grid, &mut velocity, &[], None);
    walls.apply(&mut velocity);
    rms(&velocity) / before
}

#[test]
fn the_default_projection_leaves_at_most_1e_5_of_the_divergence() {
    let shapes = [[8; 3], [16; 3], [32; 3], [64; 3], [128; 3], [64, 32, 64], [12, 7, 30], [128, 32, 128]];
    for cells in shapes {
        for (name, boundary) in [("wraps", WRAP), ("closed", CLOSED), ("open", OPEN)] {
            // One wave across the box has the least divergence for its speed, so rounding shows most.
            let extent_m = [2.0 * cells[0] as f32, cells[1] as f32, 1.5 * cells[2] as f32];
            let wave = left(cells, boundary, |position, axis| {
                let phase: f64 = (0..3).map(|a| f64::from(position[a] / extent_m[a]) * TAU).sum();
                (phase + axis as f64).sin() as f32
            });
            let rough = left(cells, boundary, |position, axis| {
                let bits = position.map(|x| u64::from(x.to_bits()));
                noise(bits[0] ^ bits[1].rotate_left(21) ^ bits[2].rotate_left(42) ^ axis as u64) as f32
            });
            println!("{cells:?} {name}: {wave:.1e} of a wave, {rough:.1e} of noise");
            assert!(wave <= 1e-5 && rough <= 1e-5, "{cells:?} {name}: {wave:e} {rough:e}");
        }
    }
}

/// Air flows through a box around a block, with an inflow of 4 m/s.
#[test]
fn iterative_solvers_meet_their_tolerance_around_a_block_and_conserve_mass() {
    let tolerance = 1e-6;
    for method in [
        IterativeMethod::Jacobi,
        IterativeMethod::GaussSeidel,
        IterativeMethod::Sor,
        IterativeMethod::ConjugateGradients,
        IterativeMethod::Multigrid,
    ] {
        let faces = [[Boundary::Inflow, Boundary::Outflow], [Boundary::NoSlip, Boundary::FreeSlip], [Boundary::FreeSlip; 2]];
        let sweeps = 20_000;
        let config = Config {
            pressure: Pressure::Iterative(method, Effort { tolerance, sweeps }),
            mean_wind_m_per_s: [4.0, 0.0, 0.0],
            viscosity_m2_per_s: 0.1,
            ..still_air([16, 8, 8], [0.5; 3], faces)
        };
        let mut air = Solver::<f64>::new(&config).expect("settings are allowed");
        let solid = |[x, y, z]: [f64; 3]| (3.0..4.5).contains(&x) && y < 2.0 && (1.0..2.5).contains(&z);
        air.set_solid(solid).expect("iterative solvers go round blocks");
        let mut most_sweeps = 0;
        for _ in 0..10 {
            let report = air.step(0.05, &[]).expect("within the limits");
            assert!(report.pressure_residual <= tolerance && report.pressure_sweeps < sweeps, "{method:?}: {report:?}");
            most_sweeps = most_sweeps.max(report.pressure_sweeps);
        }
        let flow_m3_per_s = |x_m: f64| air.samples(0).filter(|(position, _)| position[0] == x_m).map(|(_, u)| u * 0.25).sum::<f64>();
        let [inlet, block, outlet] = [0.0, 4.0, 8.0].map(flow_m3_per_s);
        println!("{method:?}: {inlet:.6} m³/s in, {block:.6} past the block, {outlet:.6} out, up to {most_sweeps} sweeps");
        assert!((inlet - 4.0 * 16.0).abs() < 1e-9, "{inlet}");
        assert!((block - inlet).abs() < 1e-5 * inlet && (outlet - inlet).abs() < 1e-5 * inlet, "{method:?}: {inlet} {block} {outlet}");
        let through_solid =
            air.samples(0).filter(|(position, _)| solid([position[0] - 0.25, position[1], position[2]])).map(|(_, u)| u.abs());
        assert_eq!(through_solid.fold(0.0, f64::max), 0.0, "{method:?}: air flows through the block");
    }
}
