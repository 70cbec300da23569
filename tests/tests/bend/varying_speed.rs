//! Waves of θ whose speed varies by Eq. (4): with their momentum kept (`Scheme::Substepped`), and with their motion kept as published (`Scheme::Verlet`).
//! Without damping and stiffness the two differ in nothing else.

use std::f64::consts::TAU;

use prairie_charts::norms::fitted_order;
use prairie_charts::problems::bend::{OneGrid, cells};
use prairie_core::bend::{Bend, Damping, Edges, Field, Kinds, Scheme, Serial, WaveParams};
use prairie_core::grid::PatchLayout;

use crate::limits::random;

const SIDE: usize = 32;
const WAVES: WaveParams = WaveParams {
    c0_m_per_s: 2.0,
    mu_m_per_rad: 0.5,
    c_omega_m_per_s: 2.0,
    theta_damping_per_s: 0.0,
    omega_damping_per_s: 0.0,
    stiffness_per_s2: 0.0,
};
const CELL_M: f32 = 0.4572;

/// Speed of θ (m/s) by Eq. (4).
fn speed(omega: [f64; 2]) -> f64 {
    f64::from(WAVES.c0_m_per_s) + f64::from(WAVES.mu_m_per_rad) * omega[0].hypot(omega[1])
}

fn at(i: usize, j: usize, side: usize) -> usize {
    (j % side) * side + i % side
}

/// Five-point Laplacian with periodic edges, times the square of the side of a cell.
fn laplacian(value: impl Fn(usize) -> f64, i: usize, j: usize, side: usize) -> f64 {
    let [east, west] = [i + 1, i + side - 1].map(|i| value(at(i, j, side)));
    let [south, north] = [j + 1, j + side - 1].map(|j| value(at(i, j, side)));
    east + west + south + north - 4.0 * value(at(i, j, side))
}

/// `⟨v/r, v/r⟩ − ⟨θ, L·θ⁻⟩ + κ·(h/c₀)²·⟨θ, θ⁻⟩` with `v = θ − θ⁻` and the Courant number r in the middle between θ⁻ and θ.
fn energy(field: &Field, dt_secs: f32) -> f64 {
    let [mut now, mut before, mut r] = [0; 3].map(|_| vec![0.0; SIDE * SIDE]);
    for ([i, j], states) in cells(field) {
        let cell = at(i, j, SIDE);
        [now[cell], before[cell]] = states.map(|state| f64::from(state.theta));
        let omega = [0, 1].map(|axis| 0.5 * states.iter().map(|state| f64::from(state.omega[axis])).sum::<f64>());
        r[cell] = speed(omega) * f64::from(dt_secs) / f64::from(CELL_M);
    }
    let waves = field.kinds().waves()[0];
    let stiffness = f64::from(waves.stiffness_per_s2) * (f64::from(CELL_M) / f64::from(waves.c0_m_per_s)).powi(2);
    let of_cell = |n: usize| {
        let force = stiffness * before[n] - laplacian(|n| before[n], n % SIDE, n / SIDE, SIDE);
        ((now[n] - before[n]) / r[n]).powi(2) + now[n] * force
    };
    (0..SIDE * SIDE).map(of_cell).sum()
}

/// Least and greatest energy relative to that at the start.
fn energies(scheme: Scheme, stiffness_per_s2: f32, dt_secs: f32) -> [f64; 2] {
    const SECS: f32 = 20.0;
    let layout = PatchLayout { count: [2, 2], cells: SIDE as u32 / 2, cell_m: CELL_M };
    let mut field = Field::new(layout, Kinds::one(WaveParams { stiffness_per_s2, ..WAVES })).with_edges(Edges::Wrapped);
    field.start(dt_secs, |at_m| {
        let [i, j] = at_m.map(|m| (m / CELL_M) as usize);
        let [theta, x, z] = [0, 1, 2].map(|channel| random(i + channel * SIDE, j) as f32 / 2.0f32.powi(23) - 1.0);
        [Bend { theta: 0.1 * theta, omega: [5.0 * x, 5.0 * z] }; 2]
    });
    field.step(scheme, dt_secs, &Serial).unwrap();
    let first = energy(&field, dt_secs);
    let [mut least, mut most] = [first; 2];
    for _ in 0..(SECS / dt_secs) as u32 {
        assert_eq!(field.step(scheme, dt_secs, &Serial).unwrap().substeps, 1);
        if field.awake_count() < 4 {
            break;
        }
        let now = energy(&field, dt_secs);
        (least, most) = (least.min(now), most.max(now));
    }
    [least / first, most / first]
}

/// With the motion kept, each fall of the speed adds `|v|²·(1/r² − 1/r⁻²)`, however short the steps.
#[test]
fn the_energy_of_a_wave_is_constant_where_its_speed_varies_if_it_keeps_its_momentum() {
    for hz in [120.0, 240.0, 480.0] {
        for stiffness_per_s2 in [0.0, 20.0] {
            let [least, most] = energies(Scheme::Substepped, stiffness_per_s2, 1.0 / hz);
            println!("{hz} Hz, κ = {stiffness_per_s2}: between {least:.5} and {most:.5} of the first");
            assert!(least > 0.99 && most < 1.01, "{hz} Hz, κ = {stiffness_per_s2}: between {least} and {most}");
        }
        let [_, kept] = energies(Scheme::Verlet, 0.0, 1.0 / hz);
        println!("{hz} Hz, as published: up to {kept:.0}");
        assert!(kept > 50.0, "{hz} Hz, as published: {kept}");
    }
}

/// θ after 3 s on 16 × 16 cells of 1 m, from smooth states without velocity.
fn smooth_waves(damping_per_s: f32, stiffness_per_s2: f32, damping: Damping, steps_per_s: u16) -> Vec<f64> {
    const COUNT: usize = 16;
    let waves = WaveParams { theta_damping_per_s: damping_per_s, omega_damping_per_s: damping_per_s, stiffness_per_s2, ..WAVES };
    let layout = PatchLayout { count: [1, 1], cells: COUNT as u32, cell_m: 1.0 };
    let mut grid = OneGrid::<f64>::like(&Field::new(layout, Kinds::one(waves)), Edges::Wrapped);
    let [c0, c_omega, stiffness] = [waves.c0_m_per_s, waves.c_omega_m_per_s, stiffness_per_s2].map(f64::from);
    let now = |n: usize| {
        let [x, z] = [n % COUNT, n / COUNT].map(|n| TAU * n as f64 / COUNT as f64);
        [0.5 * x.cos() + 0.3 * z.sin(), 3.0 + 2.0 * (x + z).cos(), 2.0 * z.cos()]
    };
    let dt_secs = 1.0 / f64::from(steps_per_s);
    grid.start(dt_secs as f32, |[i, j]| {
        let now_here = now(at(i, j, COUNT));
        let before = std::array::from_fn(|channel| {
            let (c, restoring) = if channel == 0 {
                let c = speed([now_here[1], now_here[2]]);
                (c, if damping == Damping::Exact { stiffness * (c / c0).powi(2) } else { stiffness })
            } else {
                (c_omega, stiffness)
            };
            let acceleration = c * c * laplacian(|n| now(n)[channel], i, j, COUNT) - restoring * now_here[channel];
            now_here[channel] + 0.5 * dt_secs * dt_secs * acceleration
        });
        [now_here, before]
    });
    (0..3 * u32::from(steps_per_s)).for_each(|_| grid.step(damping, 1, dt_secs as f32));
    grid.thetas().to_vec()
}

#[test]
fn the_order_in_time_is_two_where_the_speed_varies() {
    for [damping, stiffness] in [[0.0, 0.0], [0.8, 0.0], [0.8, 1.5]] {
        let run = |steps_per_s| smooth_waves(damping, stiffness, Damping::Exact, steps_per_s);
        let exact = run(2560);
        let errors = [20, 40, 80, 160].map(|steps_per_s| {
            let squares: f64 = run(steps_per_s).iter().zip(&exact).map(|(found, exact)| (found - exact).powi(2)).sum();
            (1.0 / f64::from(steps_per_s), (squares / exact.len() as f64).sqrt())
        });
        let order = fitted_order(&errors);
        println!("k = {damping}, κ = {stiffness}: order {order:.2}, errors {errors:?}");
        assert!((order - 2.0).abs() < 0.15, "k = {damping}, κ = {stiffness}: order {order:.2} from {errors:?}");
    }
}
