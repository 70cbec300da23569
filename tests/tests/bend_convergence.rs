//! The Verlet scheme against exact standing modes: its orders, its stability bound; and patches against one grid.
//!
//! The scheme takes the damping from the step before (001 Eqs 5–6), so it is of second order in space, and in time of second order
//! without damping, of first with it.

use proptest::prelude::*;
use shared::bend::{Bend, Coefficients, Field, Patch, WaveParams, verlet};
use shared::grid::PatchLayout;
use std::f64::consts::PI;
use tests::norms::{Norms, fitted_order};

const SIDE_M: f64 = 16.0;
const END_SECS: f64 = 2.0;

const WAVE: WaveParams = WaveParams {
    c0_m_per_s: 2.0,
    mu_m_per_rad: 0.0,
    c_omega_m_per_s: 3.0,
    theta_damping_per_s: 0.8,
    omega_damping_per_s: 0.0,
    stiffness_per_s2: 1.5,
};

/// Half waves of the mode along each axis: enough that its error stands out from the rounding of f32.
const HALF_WAVES: f64 = 3.0;

/// Cell side (m): the ghosts are at rest one cell beyond the outermost centres, so the square is `side + 1` cells wide.
fn spacing_m(side: usize) -> f64 {
    SIDE_M / (side as f64 + 1.0)
}

/// Wave number of the mode along an axis (1/m).
fn wave_number(_side: usize) -> f64 {
    HALF_WAVES * PI / SIDE_M
}

/// The same as the five-point Laplacian sees it: `(2/h)·sin(qh/2)`.
fn grid_wave_number(side: usize) -> f64 {
    let h = spacing_m(side);
    2.0 / h * (0.5 * wave_number(side) * h).sin()
}

/// Error after 2 s of a channel's standing mode `e^(−kt/2)·cos(ωt)·sin(qx)·sin(qz)`, `ω² = 2c²q² + κ − k²/4`, on a square whose edge is
/// at rest. Channel 0 is damped, channel 1 is not; both start with the mode's own velocity.
fn error(channel: usize, side: usize, dt_secs: f64, wave_number: f64) -> Norms {
    let c = f64::from([WAVE.c0_m_per_s, WAVE.c_omega_m_per_s][channel]);
    let k = f64::from([WAVE.theta_damping_per_s, WAVE.omega_damping_per_s][channel]);
    let omega = (2.0 * (c * wave_number).powi(2) + f64::from(WAVE.stiffness_per_s2) - 0.25 * k * k).sqrt();
    let h = spacing_m(side);
    let shape = |n: usize| (HALF_WAVES * PI * (n as f64 + 1.0) * h / SIDE_M).sin();
    let exact = |t: f64, (i, j): (usize, usize)| (-0.5 * k * t).exp() * (omega * t).cos() * shape(i) * shape(j);
    let cells = || (0..side * side).map(|n| (n % side, n / side));
    let set = |patch: &mut Patch, t: f64| {
        for (i, j) in cells() {
            let value = exact(t, (i, j)) as f32;
            patch.set(i, j, Bend { theta: value, omega: [value; 2] });
        }
    };
    let steps = (END_SECS / dt_secs).round();
    let dt = END_SECS / steps;
    let mut patch = Patch::new(side);
    set(&mut patch, -dt);
    patch.remember();
    set(&mut patch, 0.0);
    let coefficients = Coefficients::new(&WAVE, h as f32, dt as f32);
    for _ in 0..steps as u32 {
        verlet::step(&mut patch, &coefficients);
    }
    let found = |(i, j)| if channel == 0 { patch.bend(i, j).theta } else { patch.bend(i, j).omega[1] };
    Norms::of(cells().map(|cell| (f64::from(found(cell)), exact(END_SECS, cell))))
}

fn assert_order(what: &str, expected: f64, errors: &[(f64, Norms)]) {
    for norm in [|n: &Norms| n.l1, |n: &Norms| n.l2, |n: &Norms| n.linf] {
        let points: Vec<_> = errors.iter().map(|(size, norms)| (*size, norm(norms))).collect();
        let order = fitted_order(&points);
        println!("{what}: order {order:.3}, (size, error) {points:?}");
        assert!((order - expected).abs() < 0.2, "{what}: order {order:.2} from {points:?}");
    }
}

#[test]
fn undamped_modes_converge_at_second_order_in_space_and_time() {
    let errors = [16, 24, 32, 48].map(|side| (spacing_m(side), error(1, side, spacing_m(side) / 8.0, wave_number(side))));
    assert_order("undamped, dt in proportion to h", 2.0, &errors);
}

#[test]
fn damped_modes_converge_at_first_order_in_time() {
    // Against the mode of the grid, whose error in space is none.
    let errors = [0.08, 0.04, 0.02, 0.01].map(|dt_secs| (dt_secs, error(0, 16, dt_secs, grid_wave_number(16))));
    assert_order("damped, fixed grid", 1.0, &errors);
}

/// Whether a checkerboard, the first mode to fail, stays bounded for 4000 steps at Courant number `r`.
fn is_bounded(r: f32, damping_per_s: f32, stiffness_per_s2: f32) -> bool {
    const DT_SECS: f32 = 0.01;
    let params = WaveParams {
        c0_m_per_s: r / DT_SECS,
        mu_m_per_rad: 0.0,
        c_omega_m_per_s: 0.0,
        theta_damping_per_s: damping_per_s,
        omega_damping_per_s: 0.0,
        stiffness_per_s2,
    };
    let k = Coefficients::new(&params, 1.0, DT_SECS);
    let side = 64;
    let mut patch = Patch::new(side);
    for (i, j) in (0..side * side).map(|n| (n % side, n / side)) {
        patch.press(i, j, Bend { theta: if (i + j) % 2 == 0 { 1e-3 } else { -1e-3 }, omega: [0.0; 2] });
    }
    (0..4000).all(|_| verlet::step(&mut patch, &k).theta_rad < 1e3)
}

#[test]
fn the_stability_bound_is_where_the_scheme_fails() {
    for (damping, stiffness) in [(0.0, 0.0), (20.0, 0.0), (200.0, 0.0), (50.0, 5000.0), (6.0, 1.2)] {
        let (mut bounded, mut fails) = (0.0_f32, 1.0);
        for _ in 0..10 {
            let middle = 0.5 * (bounded + fails);
            if is_bounded(middle, damping, stiffness) { bounded = middle } else { fails = middle }
        }
        let lambda = 1.0 - (-damping * 0.01_f32).exp();
        let bound = verlet::courant_limit(lambda, stiffness * 1e-4);
        println!("k = {damping}, κ = {stiffness}: fails at {bounded:.4}, bound {bound:.4}");
        assert!((bounded / bound - 1.0).abs() < 0.02, "k = {damping}, κ = {stiffness}: fails at {bounded}, bound {bound}");
    }
}

/// A strike elsewhere makes all grass take shorter sub-steps for a tick; grass that rises meanwhile must not notice.
#[test]
fn a_changing_sub_step_leaves_the_motion_as_it_was() {
    const TICK_SECS: f32 = 1.0 / 60.0;
    let params = WaveParams { c0_m_per_s: 0.0, theta_damping_per_s: 2.0, stiffness_per_s2: 9.0, ..WAVE };
    let risen = |substeps: &dyn Fn(u32) -> u32| {
        let mut patch = Patch::new(8);
        patch.press(3, 3, Bend { theta: 1.0, omega: [0.0; 2] });
        for tick in 0..45 {
            let count = substeps(tick);
            let k = Coefficients::new(&params, 0.25, TICK_SECS / count as f32);
            for _ in 0..count {
                verlet::step(&mut patch, &k);
            }
        }
        f64::from(patch.bend(3, 3).theta)
    };
    // θ'' = −κθ − kθ' from rest.
    let (t, beta, omega) = (0.75, 1.0, 8.0_f64.sqrt());
    let exact = f64::exp(-beta * t) * ((omega * t).cos() + beta / omega * (omega * t).sin());
    let steady = risen(&|_| 1) - exact;
    let struck = risen(&|tick| if tick % 3 == 0 { 7 } else { 1 }) - exact;
    println!("error with one sub-step a tick {steady:.4}, with seven now and then {struck:.4}");
    assert!(struck.abs() < 1.5 * steady.abs().max(5e-3), "{struck} against {steady}");
}

/// Presses a few cells near `(x, z)`, wherever they lie.
fn press(field: &mut Field, [x, z]: [usize; 2], [theta, u, w]: [f32; 3]) {
    let layout = *field.layout();
    let cells = layout.cells as usize;
    for (dx, dz) in [(0, 0), (1, 0), (0, 1), (2, 3)] {
        let (x, z) = (x + dx, z + dz);
        if let Some(index) = layout.index((x / cells) as i64, (z / cells) as i64) {
            field.wake(index).press(x % cells, z % cells, Bend { theta, omega: [u, w] });
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn many_patches_equal_one_grid_bit_for_bit(
        bumps in prop::collection::vec(([0..24_usize, 0..24], [0.1..1.4_f32, -70.0..70.0, -70.0..70.0]), 1..6),
        steps in 1..40_usize,
    ) {
        let params = WaveParams { mu_m_per_rad: 0.05, omega_damping_per_s: 3.0, ..WAVE };
        let mut many = Field::new(PatchLayout { count: [3, 3], cells: 8, cell_m: 0.3 });
        let mut one = Field::new(PatchLayout { count: [1, 1], cells: 24, cell_m: 0.3 });
        (0..9).for_each(|index| { many.wake(index); });
        one.wake(0);
        for (at, bend) in bumps {
            press(&mut many, at, bend);
            press(&mut one, at, bend);
        }
        for _ in 0..steps {
            prop_assert_eq!(many.step(&params, 1.0 / 60.0), one.step(&params, 1.0 / 60.0));
        }
        let whole = one.patch(0).expect("it is awake");
        for (index, patch) in many.awake() {
            let [px, pz] = many.layout().place(index).map(|n| n as usize * 8);
            for (i, j) in (0..64).map(|n| (n % 8, n / 8)) {
                let (part, whole) = (patch.bend(i, j), whole.bend(px + i, pz + j));
                prop_assert_eq!(part.theta.to_bits(), whole.theta.to_bits());
                prop_assert_eq!(part.omega.map(f32::to_bits), whole.omega.map(f32::to_bits));
            }
        }
    }
}
