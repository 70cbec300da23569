use super::*;
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// `(shift − ∇²)·φ`, computed value by value from the definition of each axis.
fn apply(cells: [usize; 3], spacing_m: [f64; 3], axes: [Basis; 3], shift: f64, phi: &[f64]) -> Vec<f64> {
    let strides = [1, cells[0], cells[0] * cells[1]];
    let neighbour = |at: usize, axis: usize, upwards: bool| {
        let n = cells[axis];
        let j = at / strides[axis] % n;
        let is_inside = if upwards { j + 1 < n } else { j > 0 };
        match axes[axis] {
            _ if is_inside && upwards => phi[at + strides[axis]],
            _ if is_inside => phi[at - strides[axis]],
            Basis::Wrap if upwards => phi[at - (n - 1) * strides[axis]],
            Basis::Wrap => phi[at + (n - 1) * strides[axis]],
            Basis::Nodes(edges) if edges[usize::from(upwards)] == Edge::Dirichlet => 0.0,
            Basis::Nodes(_) if n == 1 => 0.0,
            Basis::Nodes(_) if upwards => phi[at - strides[axis]],
            Basis::Nodes(_) => phi[at + strides[axis]],
            Basis::Centres(edges) if edges[usize::from(upwards)] == Edge::Neumann => phi[at],
            Basis::Walls(walls) if !walls[usize::from(upwards)] => phi[at],
            Basis::Walls(_) if n > 1 => {
                let next = if upwards { at - strides[axis] } else { at + strides[axis] };
                (phi[next] - 6.0 * phi[at]) / 3.0
            }
            Basis::Walls(_) => -phi[at],
            Basis::Centres(_) => -phi[at],
        }
    };
    let minus_laplacian = |at: usize| -> f64 {
        (0..3).map(|axis| (2.0 * phi[at] - neighbour(at, axis, false) - neighbour(at, axis, true)) / spacing_m[axis].powi(2)).sum()
    };
    (0..phi.len()).map(|at| shift * phi[at] + minus_laplacian(at)).collect()
}

/// Uncorrelated pseudorandom numbers in ±1 (SplitMix64).
fn random_field(len: usize, seed: u64) -> Vec<f64> {
    let mut random = SplitMix64::seed_from_u64(seed);
    (0..len).map(|_| random.next_u64() as i64 as f64 / 2f64.powi(63)).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn norm(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>().sqrt()
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    norm(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>())
}

const NEUMANN: Basis = Basis::Centres([Edge::Neumann; 2]);
const BASES: [Basis; 12] = [
    Basis::Wrap,
    NEUMANN,
    Basis::Centres([Edge::Dirichlet; 2]),
    Basis::Centres([Edge::Neumann, Edge::Dirichlet]),
    Basis::Centres([Edge::Dirichlet, Edge::Neumann]),
    Basis::Nodes([Edge::Dirichlet; 2]),
    FREE_NODES,
    Basis::Nodes([Edge::Neumann, Edge::Dirichlet]),
    Basis::Nodes([Edge::Dirichlet, Edge::Neumann]),
    Basis::Walls([true; 2]),
    Basis::Walls([true, false]),
    Basis::Walls([false, true]),
];
const FREE_NODES: Basis = Basis::Nodes([Edge::Neumann; 2]);

/// Whether the equation has a solution: nodes between Neumann edges are at least two, and alone need a shift.
fn is_solvable(cells: [usize; 3], axes: [Basis; 3], shift: f64) -> bool {
    let is_free = |axis: usize| axes[axis] == FREE_NODES;
    let is_bound = axes.iter().any(|axis| !is_free_axis(*axis));
    (0..3).all(|axis| !is_free(axis) || cells[axis] > 1) && (shift > 0.0 || is_bound || !(0..3).any(is_free))
}

fn is_free_axis(axis: Basis) -> bool {
    [Basis::Wrap, NEUMANN, FREE_NODES].contains(&axis)
}

fn has_constant(axes: [Basis; 3]) -> bool {
    axes.iter().all(|axis| [Basis::Wrap, NEUMANN].contains(axis))
}

/// Solves for a random right-hand side; returns the residual relative to the compatible part of the right-hand side.
fn residual_of_random(cells: [usize; 3], spacing_m: [f64; 3], axes: [Basis; 3], shift: f64, seed: u64) -> f64 {
    let mut right = random_field(cells.iter().product(), seed);
    let mut phi = right.clone();
    Separable::new(cells, spacing_m, axes).solve(shift, &mut phi);
    if shift == 0.0 && has_constant(axes) {
        let dropped = mean(&right);
        right.iter_mut().for_each(|value| *value -= dropped);
        assert!(mean(&phi).abs() <= 1e-14 * norm(&phi), "{cells:?} {axes:?}: the mean of φ is {}", mean(&phi));
    }
    let left = apply(cells, spacing_m, axes, shift, &phi);
    let scale = norm(&right);
    difference(&left, &right) / if scale > 0.0 { scale } else { 1.0 }
}

#[test]
fn every_combination_of_bases_and_lengths_solves_its_equation() {
    const LENGTHS: [[usize; 3]; 12] = [
        [1, 1, 1],
        [2, 2, 2],
        [1, 6, 1],
        [9, 1, 1],
        [3, 1, 7],
        [1, 1, 5],
        [4, 3, 2],
        [8, 8, 8],
        [11, 16, 1],
        [13, 10, 9],
        [7, 12, 16],
        [20, 17, 5],
    ];
    let mut worst: f64 = 0.0;
    for (n, cells) in LENGTHS.into_iter().enumerate() {
        for combination in 0..BASES.len().pow(3) {
            let axes = from_fn(|axis| BASES[combination / BASES.len().pow(axis as u32) % BASES.len()]);
            for shift in [0.0, 0.7, 1e3].into_iter().filter(|&shift| is_solvable(cells, axes, shift)) {
                let residual = residual_of_random(cells, [0.5, 1.0, 1.7], axes, shift, n as u64);
                assert!(residual <= 1e-12, "{cells:?} {axes:?} shift {shift}: residual {residual:e}");
                worst = worst.max(residual);
            }
        }
    }
    println!("largest relative residual {worst:.1e}");
}

#[test]
fn lengths_with_and_without_large_factors_solve_in_every_basis() {
    for basis in BASES {
        for n in (1..=36).chain([60, 63, 64, 97, 127, 128, 210]) {
            for cells in [[n, 3, 2], [3, n, 2], [2, 3, n]] {
                let Some(shift) = [0.0, 0.7].into_iter().find(|&shift| is_solvable(cells, [basis; 3], shift)) else { continue };
                let residual = residual_of_random(cells, [1.0, 0.8, 1.1], [basis; 3], shift, n as u64);
                assert!(residual <= 1e-12, "{cells:?} {basis:?}: residual {residual:e}");
            }
        }
    }
}

/// The solver's inverse matrix, column by column, against elimination with pivoting.
#[test]
fn it_agrees_with_a_dense_solution() {
    let (cells, spacing_m, shift) = ([4, 3, 5], [0.5, 0.7, 1.3], 0.3);
    let len = 60;
    for (n, &first) in BASES.iter().enumerate() {
        let axes = [first, BASES[(n + 2) % BASES.len()], BASES[(n + 3) % BASES.len()]];
        let columns: Vec<_> = (0..len).map(|k| apply(cells, spacing_m, axes, shift, &unit(len, k))).collect();
        let right = random_field(len, n as u64);
        let mut rows: Vec<Vec<f64>> = (0..len).map(|i| columns.iter().map(|column| column[i]).chain([right[i]]).collect()).collect();
        let dense = eliminate(&mut rows);
        let mut phi = right;
        Separable::new(cells, spacing_m, axes).solve(shift, &mut phi);
        assert!(difference(&phi, &dense) <= 1e-13 * norm(&dense), "{axes:?}");
    }
}

fn unit(len: usize, k: usize) -> Vec<f64> {
    (0..len).map(|i| if i == k { 1.0 } else { 0.0 }).collect()
}

/// Gauss–Jordan elimination with partial pivoting; each row ends in its right-hand side.
fn eliminate(rows: &mut [Vec<f64>]) -> Vec<f64> {
    let n = rows.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|&a, &b| rows[a][k].abs().total_cmp(&rows[b][k].abs())).unwrap_or(k);
        rows.swap(k, pivot);
        let pivot_row = rows[k].clone();
        for (i, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let factor = row[k] / pivot_row[k];
            assert!(factor.is_finite(), "singular at {i}, {k}");
            row.iter_mut().zip(&pivot_row).for_each(|(value, pivot)| *value -= factor * pivot);
        }
    }
    rows.iter().enumerate().map(|(k, row)| row[n] / row[k]).collect()
}

/// A constant right-hand side f gives φ = f/shift without loss of digits, however small the shift.
#[test]
fn nearly_singular_systems_keep_their_digits() {
    for basis in [Basis::Wrap, NEUMANN] {
        for shift in [1e-3, 1e-12, 1e-30] {
            let mut phi = vec![3.0; 16 * 9 * 12];
            Separable::new([16, 9, 12], [1.0; 3], [basis; 3]).solve(shift, &mut phi);
            for value in phi {
                assert!((value * shift / 3.0 - 1.0).abs() <= 1e-13, "{basis:?} shift {shift:e}: {value:e}");
            }
        }
    }
}

#[test]
fn a_right_hand_side_without_solution_loses_its_mean_only() {
    let mut phi = vec![4.2; 12 * 8 * 10];
    Separable::new([12, 8, 10], [1.0; 3], [NEUMANN, Basis::Wrap, NEUMANN]).solve(0.0, &mut phi);
    assert!(norm(&phi) <= 1e-12, "{:e}", norm(&phi));
}

/// Unlike the random one, a smooth right-hand side shows the full rounding error of φ, amplified by `(n/π)²`.
#[test]
fn residual_at_working_sizes() {
    for (cells, axes) in [([128; 3], [NEUMANN; 3]), ([64, 32, 64], [Basis::Wrap, NEUMANN, Basis::Wrap])] {
        let random = residual_of_random(cells, [1.0; 3], axes, 0.0, 1);
        let exact = cosines(cells);
        let right = apply(cells, [1.0; 3], axes, 0.0, &exact);
        let mut phi = right.clone();
        Separable::new(cells, [1.0; 3], axes).solve(0.0, &mut phi);
        let smooth = difference(&apply(cells, [1.0; 3], axes, 0.0, &phi), &right) / norm(&right);
        let error = difference(&phi, &exact) / norm(&exact);
        println!("{cells:?}: relative residual {random:.1e} of a random field, {smooth:.1e} of a smooth one, whose error is {error:.1e}");
        assert!(random <= 1e-12 && smooth <= 3e-12 && error <= 1e-13, "{random:e} {smooth:e} {error:e}");
    }
}

/// The longest wave along each axis that fits both a periodic axis and one between walls.
fn cosines(cells: [usize; 3]) -> Vec<f64> {
    let wave = |j: usize, n: usize| (2.0 * std::f64::consts::PI * (j as f64 + 0.5) / n as f64).cos();
    let index = |at: usize| [at % cells[0], at / cells[0] % cells[1], at / cells[0] / cells[1]];
    (0..cells.iter().product()).map(|at| (0..3).map(|axis| wave(index(at)[axis], cells[axis])).product()).collect()
}

#[test]
fn bits_do_not_depend_on_the_number_of_threads_or_the_past() {
    let (cells, axes) = ([37, 30, 36], [NEUMANN, Basis::Centres([Edge::Neumann, Edge::Dirichlet]), Basis::Wrap]);
    let solve = |threads: usize, solver: &mut Separable| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of threads");
        let mut phi = random_field(37 * 30 * 36, 5);
        pool.install(|| solver.solve(0.25, &mut phi));
        phi.iter().map(|value| value.to_bits()).collect::<Vec<_>>()
    };
    let mut solver = Separable::new(cells, [1.0; 3], axes);
    let alone = solve(1, &mut solver);
    solver.solve(1e3, &mut random_field(37 * 30 * 36, 6));
    assert!(alone == solve(1, &mut solver), "the past shows");
    assert!(alone == solve(2, &mut solver) && alone == solve(3, &mut solver), "the number of threads shows");
}

/// The bound by which explicit friction limits its step.
#[test]
fn the_largest_eigenvalue_between_walls_is_bounded_closely() {
    use crate::Boundary::{FreeSlip, NoSlip, Wrap};
    for cells in 2..=64 {
        for (across, walls, least) in [([NoSlip; 2], [true; 2], 0.98), ([FreeSlip, NoSlip], [false, true], 0.95)] {
            let grid = crate::Grid { cells: [1, cells, 1], spacing_m: [1.0; 3], boundary: [[Wrap; 2], across, [Wrap; 2]] };
            let bound = crate::boundary::friction::largest_eigenvalue(&grid, 1);
            let found = super::walls::eigenvalues(walls, cells).into_iter().fold(0.0, f64::max);
            assert!((least..=1.0 + 1e-12).contains(&(found / bound)), "{cells} cells, {across:?}: {found} of {bound}");
        }
    }
}
