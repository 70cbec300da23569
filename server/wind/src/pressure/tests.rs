//! Every solver against manufactured solutions, against its theory, and against itself on more threads.

use std::f64::consts::PI;

use super::Edge::{Dirichlet, Neumann};
use super::*;

const METHODS: [IterativeMethod; 5] = [
    IterativeMethod::Jacobi,
    IterativeMethod::GaussSeidel,
    IterativeMethod::Sor,
    IterativeMethod::ConjugateGradients,
    IterativeMethod::Multigrid,
];
type Edges = [Option<[Edge; 2]>; 3];
const CLOSED: Edges = [Some([Neumann; 2]); 3];
const OPEN: Edges = [Some([Dirichlet; 2]); 3];
const EDGES: [Edges; 5] =
    [CLOSED, OPEN, [None; 3], [None, Some([Neumann, Dirichlet]), None], [Some([Dirichlet, Neumann]), None, Some([Neumann; 2])]];

/// Pseudorandom numbers between −1 and 1.
fn noise(len: usize, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    (0..len).map(|_| next()).collect()
}

/// A box, with the equation written out cell by cell.
struct Case {
    cells: [usize; 3],
    spacing_m: [f64; 3],
    edges: Edges,
    solid: Vec<bool>,
}

impl Case {
    fn new(cells: [usize; 3], spacing_m: [f64; 3], edges: Edges, solid: impl Fn([usize; 3], f64) -> bool) -> Self {
        let random = noise(cells.iter().product(), 99);
        let solid = (0..random.len()).map(|i| solid(coordinates(cells, i), random[i])).collect();
        Self { cells, spacing_m, edges, solid }
    }

    fn len(&self) -> usize {
        self.solid.len()
    }

    fn solver(&self, method: IterativeMethod) -> Iterative {
        let mask = self.solid.contains(&true).then_some(&self.solid[..]);
        Iterative::new(System::new(self.cells, self.spacing_m, self.edges, mask).unwrap(), method)
    }

    /// `∇²p`.
    fn laplacian(&self, p: &[f64]) -> Vec<f64> {
        (0..p.len()).map(|i| if self.solid[i] { 0.0 } else { (0..6).map(|face| self.flux(p, i, face)).sum() }).collect()
    }

    fn flux(&self, p: &[f64], i: usize, face: usize) -> f64 {
        let (axis, up, mut cell) = (face / 2, face % 2, coordinates(self.cells, i));
        let (n, h2) = (self.cells[axis], self.spacing_m[axis].powi(2));
        if cell[axis] == [0, n - 1][up] {
            match self.edges[axis].map(|edges| edges[up]) {
                Some(Neumann) => return 0.0,
                Some(Dirichlet) => return -2.0 * p[i] / h2,
                None => {}
            }
        }
        cell[axis] = (cell[axis] + [n - 1, 1][up]) % n;
        let other = cell[0] + self.cells[0] * (cell[1] + self.cells[1] * cell[2]);
        if self.solid[other] { 0.0 } else { (p[other] - p[i]) / h2 }
    }

    /// Root mean square of `f − ∇²p` over that of f; in closed air, f must have zero mean.
    fn residual(&self, f: &[f64], p: &[f64]) -> f64 {
        let r: Vec<f64> = self.laplacian(p).iter().zip(f).map(|(a, f)| f - a).collect();
        norm(&r) / norm(f)
    }
}

fn coordinates(cells: [usize; 3], i: usize) -> [usize; 3] {
    [i % cells[0], i / cells[0] % cells[1], i / cells[0] / cells[1]]
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn shapes() -> Vec<Case> {
    let mut cases = vec![];
    for edges in EDGES {
        for (cells, spacing_m) in [
            ([6, 4, 8], [1.0; 3]),
            ([7, 5, 3], [4.0, 1.0, 2.0]),
            ([1, 6, 4], [0.5; 3]),
            ([2; 3], [1.0, 2.0, 3.0]),
            ([1; 3], [1.0; 3]),
            ([5, 1, 1], [1.0; 3]),
        ] {
            cases.push(Case::new(cells, spacing_m, edges, |_, _| false));
            cases.push(Case::new(cells, spacing_m, edges, |_, random| random.abs() < 0.2));
        }
    }
    cases
}

#[test]
fn every_method_finds_the_solution_made_up() {
    for case in shapes() {
        for method in METHODS {
            let mut solver = case.solver(method);
            let mut exact = noise(case.len(), 3);
            let system = solver.system();
            system.mask(&mut exact);
            system.regions.remove_means(&mut exact, &mut vec![0.0; system.regions.count()]);
            let f = case.laplacian(&exact);
            let mut p = noise(case.len(), 4);
            let found = solver.solve(&f, &mut p, Effort { tolerance: 1e-11, sweeps: 20_000 });
            let context = format!("{method:?} {:?} {:?} {:?}: {found:?}", case.cells, case.edges, case.solid);
            assert!(found.met(), "{context}");
            let error = p.iter().zip(&exact).map(|(p, exact)| (p - exact).abs()).fold(0.0, f64::max);
            assert!(error < 1e-8, "{context}, error {error}");
            assert!(p.iter().zip(&case.solid).all(|(&p, &solid)| !solid || p == 0.0), "{context}");
        }
    }
}

/// A lexicographic sweep written out, each cell from the newest values around it.
#[test]
fn gauss_seidel_is_the_textbook_sweep() {
    for case in shapes() {
        let f = noise(case.len(), 9);
        let mut expected = vec![0.0; case.len()];
        let system = case.solver(IterativeMethod::GaussSeidel).system().clone();
        let mut balanced = f.clone();
        system.mask(&mut balanced);
        system.regions.remove_means(&mut balanced, &mut vec![0.0; system.regions.count()]);
        for _ in 0..2 {
            for i in (0..case.len()).filter(|&i| !case.solid[i]) {
                let with = |value: f64, p: &mut Vec<f64>| {
                    p[i] = value;
                    (0..6).map(|face| case.flux(p, i, face)).sum::<f64>()
                };
                let (at_0, at_1) = (with(0.0, &mut expected), with(1.0, &mut expected));
                expected[i] = if at_0 == at_1 { 0.0 } else { (balanced[i] - at_0) / (at_1 - at_0) };
            }
        }
        system.regions.remove_means(&mut expected, &mut vec![0.0; system.regions.count()]);
        let mut p = vec![0.0; case.len()];
        case.solver(IterativeMethod::GaussSeidel).solve(&f, &mut p, Effort { tolerance: 0.0, sweeps: 2 });
        let error = p.iter().zip(&expected).map(|(p, expected)| (p - expected).abs()).fold(0.0, f64::max);
        assert!(error < 1e-9 * (1.0 + norm(&expected)), "{:?} {:?} {:?}: {error}", case.cells, case.edges, case.solid);
    }
}

#[test]
fn the_reported_residual_is_the_true_one() {
    for case in shapes().iter().filter(|case| case.len() > 20) {
        for method in METHODS {
            for sweeps in [0, 1, 6] {
                let f = case.laplacian(&noise(case.len(), 5));
                let mut p = vec![0.0; case.len()];
                let found = case.solver(method).solve(&f, &mut p, Effort { tolerance: 0.0, sweeps });
                let truth = case.residual(&f, &p);
                assert!((found.residual - truth).abs() < 1e-12 + 1e-9 * truth, "{method:?} {sweeps}: {} is {truth}", found.residual);
                assert!(!found.met() && found.sweeps == sweeps || found.residual < 1e-13, "{method:?}: {found:?}");
            }
        }
    }
}

#[test]
fn a_solution_known_beforehand_takes_no_sweep() {
    let case = Case::new([8, 6, 4], [1.0; 3], EDGES[3], |_, random| random.abs() < 0.1);
    for method in METHODS {
        let f = case.laplacian(&noise(case.len(), 6));
        let (mut solver, mut p, effort) = (case.solver(method), vec![0.0; case.len()], Effort { tolerance: 1e-9, sweeps: 5000 });
        assert!(solver.solve(&f, &mut p, effort).sweeps > 0);
        let once = p.clone();
        let again = solver.solve(&f, &mut p, effort);
        assert!(again.met() && again.sweeps == 0, "{method:?}: {again:?}");
        assert!(once.iter().zip(&p).all(|(a, b)| (a - b).abs() < 1e-12));
    }
}

#[test]
fn closed_air_leaves_the_mean_out() {
    let case = Case::new([6, 5, 4], [1.0; 3], CLOSED, |cell, _| cell[0] == 3);
    for method in METHODS {
        let mut p = noise(case.len(), 1);
        let constant = case.solver(method).solve(&vec![0.1; case.len()], &mut p, Effort { tolerance: 1e-6, sweeps: 100 });
        assert!(constant.met() && constant.sweeps == 0 && p.iter().all(|&p| p == 0.0), "{method:?}: {constant:?}");

        // A different mean on each side of the wall.
        let mut f = case.laplacian(&noise(case.len(), 8));
        let balanced = f.clone();
        f.iter_mut().enumerate().for_each(|(i, f)| *f += if i % 6 < 3 { 2.0 } else { -7.0 });
        assert!(case.solver(method).solve(&f, &mut p, Effort { tolerance: 1e-9, sweeps: 5000 }).met());
        assert!(case.residual(&balanced, &p) < 1e-8, "{method:?}");
    }
}

#[test]
fn values_that_are_not_finite_miss_the_tolerance() {
    let case = Case::new([6, 5, 4], [1.0; 3], EDGES[3], |_, _| false);
    for (method, value) in METHODS.into_iter().flat_map(|method| [(method, f64::NAN), (method, f64::INFINITY)]) {
        let mut f = noise(case.len(), 1);
        f[17] = value;
        let found = case.solver(method).solve(&f, &mut vec![0.0; case.len()], Effort { tolerance: 1e-3, sweeps: 20 });
        assert!(!found.met() && found.sweeps <= 20, "{method:?}: {found:?}");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    // Periodic axes of odd and even numbers of cells; enough planes to run in parallel.
    let case = Case::new([65, 32, 40], [1.0, 1.0, 3.0], EDGES[3], |_, random| random.abs() < 0.1);
    let f = noise(case.len(), 2);
    for method in METHODS {
        let [one, two] = [1, 2].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut p = vec![0.0; case.len()];
            let found = pool.install(|| case.solver(method).solve(&f, &mut p, Effort { tolerance: 1e-9, sweeps: 6 }));
            (p, found)
        });
        assert!(one == two, "{method:?}");
    }
}

/// Mean factor of the residual per sweep between two numbers of sweeps, from rest.
fn factor(case: &Case, method: IterativeMethod, from: u32, to: u32) -> f64 {
    let f = case.laplacian(&noise(case.len(), 12));
    let after = |sweeps| case.solver(method).solve(&f, &mut vec![0.0; case.len()], Effort { tolerance: 0.0, sweeps }).residual;
    (after(to) / after(from)).powf(1.0 / f64::from(to - from))
}

#[test]
fn relaxation_converges_as_theory_has_it() {
    let n = 16;
    let case = Case::new([n; 3], [1.0 / n as f64; 3], OPEN, |_, _| false);
    let radius = (PI / n as f64).cos();
    let omega = 2.0 / (1.0 + (PI / n as f64).sin());
    for (method, from, to, theory) in [
        (IterativeMethod::Jacobi, 400, 600, radius),
        (IterativeMethod::GaussSeidel, 200, 300, radius * radius),
        (IterativeMethod::Sor, 30, 60, omega - 1.0),
    ] {
        let found = factor(&case, method, from, to);
        println!("{method:?}: factor {found:.5}, theory {theory:.5}");
        assert!((found.ln() / theory.ln() - 1.0).abs() < 0.03, "{method:?}: factor {found}, theory {theory}");
    }
}

fn cycles(case: &Case) -> Convergence {
    let f = noise(case.len(), 5);
    case.solver(IterativeMethod::Multigrid).solve(&f, &mut vec![0.0; case.len()], Effort { tolerance: 1e-8, sweeps: 100 })
}

fn hill([x, y, z]: [usize; 3], [nx, ny, nz]: [usize; 3]) -> bool {
    let (fx, fz) = (9.0 * x as f64 / nx as f64, 7.0 * z as f64 / nz as f64);
    (y as f64) < ny as f64 * (0.3 + 0.25 * (fx.sin() * fz.cos() + 0.4 * (3.1 * fx).sin()))
}

fn assert_few_cycles(boxes: &[[usize; 3]], spacings_m: &[[f64; 3]]) {
    let mut most = [0; 2];
    for (&cells, &spacing_m) in boxes.iter().flat_map(|cells| spacings_m.iter().map(move |spacing_m| (cells, spacing_m))) {
        for edges in EDGES {
            let cases = [
                Case::new(cells, spacing_m, edges, |_, _| false),
                Case::new(cells, spacing_m, edges, |_, random| random.abs() < 0.1),
                Case::new(cells, spacing_m, edges, |_, random| random.abs() < 0.3),
                Case::new(cells, spacing_m, edges, |cell, _| hill(cell, cells)),
            ];
            for (number, case) in cases.iter().enumerate() {
                let (found, limit) = (cycles(case), [16, 25, 25, 25][number]);
                assert!(found.met() && found.sweeps <= limit, "{cells:?} {spacing_m:?} {edges:?} solids {number}: {found:?}");
                most[number.min(1)] = most[number.min(1)].max(found.sweeps);
            }
        }
    }
    println!("at most {} cycles to 1e-8, {} among solids", most[0], most[1]);
}

#[test]
fn multigrid_takes_few_cycles_whatever_the_box() {
    let boxes = [[8; 3], [16; 3], [32, 8, 32], [7, 5, 30], [17, 9, 15], [2; 3], [1; 3]];
    assert_few_cycles(&boxes, &[[1.0; 3], [8.0, 2.0, 8.0], [1.0, 10.0, 1.0], [10.0, 1.0, 1.0], [1.0, 3.0, 10.0]]);
    assert_few_cycles(&[[1, 64, 64]], &[[1.0; 3]]);
}

#[test]
#[ignore = "takes a minute; cargo nextest run --release --workspace --run-ignored only -E 'test(large_boxes)'"]
fn multigrid_takes_few_cycles_in_large_boxes() {
    assert_few_cycles(
        &[[64; 3], [128, 32, 128], [33, 17, 65]],
        &[[1.0; 3], [8.0, 2.0, 8.0], [1.0, 10.0, 1.0], [10.0, 1.0, 1.0], [1.0, 3.0, 10.0]],
    );
}

/// A wall with one hole: the coarser grids merge cells that the finest keeps apart, which costs cycles but not convergence.
#[test]
fn a_hole_in_a_wall_is_found() {
    for spacing_m in [[1.0; 3], [8.0, 2.0, 8.0], [1.0, 3.0, 10.0]] {
        let case = Case::new([16; 3], spacing_m, [Some([Neumann, Dirichlet]), Some([Neumann; 2]), None], |cell, _| {
            cell[0] == 8 && cell[1..] != [8, 8]
        });
        let found = cycles(&case);
        assert!(found.met() && found.sweeps <= 40, "{spacing_m:?}: {found:?}");
    }
}
