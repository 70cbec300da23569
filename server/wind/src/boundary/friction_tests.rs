use super::*;
use crate::Boundary::{FreeSlip, Inflow, Lid, NoSlip, Wrap};
use crate::boundary::BoundaryConditions;
use crate::diffuse::{Implicit, explicit, gauss_seidel};

const UPPER_M_PER_S: f64 = 7.0;
const HEIGHT_M: f64 = 3.0;
const CURVATURE_PER_M_S: f64 = 2.5;

/// A parabola between a wall at rest and one that moves.
fn parabola([_, y, _]: [f64; 3]) -> f64 {
    UPPER_M_PER_S * y / HEIGHT_M + CURVATURE_PER_M_S * y * (y - HEIGHT_M)
}

fn channel(cells: usize) -> Grid<f64> {
    let lid = Lid { velocity_m_per_s: [UPPER_M_PER_S as f32, 0.0, 0.0] };
    let spacing_m = [1.0, HEIGHT_M / cells as f64, 1.0];
    Grid { cells: [3, cells, 2], spacing_m, boundary: [[Wrap; 2], [NoSlip, lid], [Wrap; 2]] }
}

fn filled(grid: &Grid<f64>, boundaries: &BoundaryConditions<f64>, f: impl Fn([f64; 3]) -> f64) -> Field<f64> {
    let mut field = Field::zeros(grid, Location::Face(0));
    field.fill(grid, f);
    boundaries.apply_to_component(&mut field);
    field
}

fn largest_difference(grid: &Grid<f64>, one: &Field<f64>, f: impl Fn([f64; 3]) -> f64) -> f64 {
    one.samples(grid).map(|(position, value)| (value - f(position)).abs()).fold(0.0, f64::max)
}

/// Its curvature is `2·CURVATURE_PER_M_S`, also next to the walls, where mirrored ghosts would give three quarters of it.
#[test]
fn every_scheme_is_exact_for_a_parabola_between_walls() {
    for cells in [2, 3, 5, 8] {
        let grid = channel(cells);
        let boundaries = BoundaryConditions::new(&grid, Box::new(|_, _| [0.0; 3]));
        let start = filled(&grid, &boundaries, parabola);
        let gain = 0.3 * 2.0 * CURVATURE_PER_M_S;
        let mut target = start.clone();
        explicit(&grid, 1.0, 0.3, &start, &start, &mut target);
        let error = largest_difference(&grid, &target, |position| parabola(position) + gain);
        assert!(error < 1e-12, "explicit, {cells} cells: {error:e}");

        // The implicit schemes end at the parabola if they start from it less the gain.
        let mut earlier = filled(&grid, &boundaries, |position| parabola(position) - gain);
        let mut swept = earlier.clone();
        gauss_seidel(&grid, 1.0, 0.3, 300, &earlier, &mut swept, |field| boundaries.apply_to_component(field));
        Implicit::new(&grid).step(&grid, 1.0, 0.3, &mut earlier);
        for (name, field) in [("implicit", &earlier), ("Gauss–Seidel", &swept)] {
            let error = largest_difference(&grid, field, parabola);
            assert!(error < 1e-11, "{name}, {cells} cells: {error:e}");
        }
    }
}

/// `(1 − ν·dt·∇²)·u = start` by the explicit scheme's ∇², whatever the axes with walls.
#[test]
fn the_implicit_step_inverts_the_explicit_operator() {
    let walls = [[Inflow; 2], [NoSlip, FreeSlip], [NoSlip; 2], [Wrap; 2], [FreeSlip, Inflow]];
    for (n, cells) in [[6, 5, 4], [1, 7, 2], [9, 1, 3]].into_iter().enumerate() {
        for combination in 0..125 {
            let boundary = [0, 1, 2].map(|axis| walls[combination / 5usize.pow(axis) % 5]);
            let grid = Grid { cells, spacing_m: [0.5, 1.0, 0.8], boundary };
            let boundaries = BoundaryConditions::new(&grid, Box::new(|[x, y, z], _| [x - y, z - x, 1.0 + y * z]));
            let mut start = Field::<f64>::zeros(&grid, Location::Face(n));
            start.fill(&grid, |[x, y, z]| (7.0 * x + 3.0 * y * z).sin() + (5.0 * z).cos());
            boundaries.apply_to_component(&mut start);
            let (mut end, mut back) = (start.clone(), start.clone());
            Implicit::new(&grid).step(&grid, 1.0, 0.4, &mut end);
            boundaries.apply_to_component(&mut end);
            explicit(&grid, 1.0, -0.4, &end, &end, &mut back);
            boundaries.apply_to_component(&mut back);
            let pairs = back.values(&grid).zip(start.values(&grid));
            let error = pairs.map(|(back, start)| (back - start).abs()).fold(0.0, f64::max);
            assert!(error < 1e-11, "{cells:?} {boundary:?}: {error:e}");
        }
    }
}

/// The matrix is not symmetric, but its symmetric part is negative definite.
#[test]
fn friction_at_walls_never_adds_energy() {
    for cells in [[2, 2, 2], [3, 4, 5], [8, 2, 3]] {
        let grid = Grid { cells, spacing_m: [1.0, 0.7, 1.3], boundary: [[NoSlip; 2]; 3] };
        let boundaries = BoundaryConditions::new(&grid, Box::new(|_, _| [0.0; 3]));
        for seed in 0..300 {
            let noise = |[x, y, z]: [f64; 3]| (1e3 * (f64::from(seed) + 1.7 * x + 2.9 * y + 4.3 * z)).sin();
            let field = filled(&grid, &boundaries, noise);
            let mut changed = field.clone();
            explicit(&grid, 1.0, 1.0, &field, &field, &mut changed);
            let pairs = || field.values(&grid).zip(changed.values(&grid));
            let (power, energy) = pairs().fold([0.0; 2], |[p, e], (u, v)| [p + u * (v - u), e + u * u]).into();
            assert!(power < -0.5 * energy, "{cells:?}, seed {seed}: {power} of {energy}");
        }
    }
}
