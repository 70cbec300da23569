//! Waves of θ whose speed varies by Eq. (4), with the motion that they keep limited where it falls and without. Undamped, `Scheme::Verlet` and
//! `Scheme::Substepped` differ in nothing else.

use prairie_core::bend::{Bend, Edges, Field, Kinds, Scheme, Serial, WaveParams};
use prairie_core::grid::PatchLayout;
use tests::problems::bend::cells;

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

fn courant(omega: [f32; 2], dt_secs: f32) -> f64 {
    let omega_rad_per_s = omega.map(f64::from).map(|part| part * part).iter().sum::<f64>().sqrt();
    (f64::from(WAVES.c0_m_per_s) + f64::from(WAVES.mu_m_per_rad) * omega_rad_per_s) * f64::from(dt_secs) / f64::from(CELL_M)
}

fn at(i: usize, j: usize) -> usize {
    (j % SIDE) * SIDE + i % SIDE
}

/// Five-point Laplacian with periodic edges, times the square of the side of a cell.
fn laplacian(plane: &[f64], i: usize, j: usize) -> f64 {
    plane[at(i + 1, j)] + plane[at(i + SIDE - 1, j)] + plane[at(i, j + 1)] + plane[at(i, j + SIDE - 1)] - 4.0 * plane[at(i, j)]
}

/// `⟨v/r, v/r⟩ − ⟨θ, L·θ⁻⟩` with `v = θ − θ⁻` and the Courant number r of the step that led from θ⁻ to θ.
fn energy(field: &Field, dt_secs: f32) -> f64 {
    let [mut now, mut before, mut r] = [0; 3].map(|_| vec![0.0; SIDE * SIDE]);
    for ([i, j], states) in cells(field) {
        [now[at(i, j)], before[at(i, j)]] = states.map(|state| f64::from(state.theta));
        r[at(i, j)] = courant(states[1].omega, dt_secs);
    }
    let of_cell = |n: usize| ((now[n] - before[n]) / r[n]).powi(2) - now[n] * laplacian(&before, n % SIDE, n / SIDE);
    (0..SIDE * SIDE).map(of_cell).sum()
}

/// Greatest energy relative to that at the start, and the last.
fn energies(scheme: Scheme, dt_secs: f32) -> [f64; 2] {
    const SECS: f32 = 20.0;
    let mut field =
        Field::new(PatchLayout { count: [2, 2], cells: SIDE as u32 / 2, cell_m: CELL_M }, Kinds::one(WAVES)).with_edges(Edges::Wrapped);
    field.start(dt_secs, |at_m| {
        let [i, j] = at_m.map(|m| (m / CELL_M) as usize);
        let [theta, x, z] = [0, 1, 2].map(|channel| random(i + channel * SIDE, j) as f32 / 2.0f32.powi(23) - 1.0);
        [Bend { theta: 0.1 * theta, omega: [5.0 * x, 5.0 * z] }; 2]
    });
    field.step(scheme, dt_secs, &Serial).unwrap();
    let first = energy(&field, dt_secs);
    let (mut most, mut last) = (first, first);
    for _ in 0..(SECS / dt_secs) as u32 {
        field.step(scheme, dt_secs, &Serial).unwrap();
        if field.awake_count() < 4 {
            break;
        }
        last = energy(&field, dt_secs);
        most = most.max(last);
    }
    [most / first, last / first]
}

/// Without the limit, each fall of the speed adds `|v|²·(1/r² − 1/r⁻²)`, however short the steps.
#[test]
fn the_energy_of_a_wave_grows_where_its_speed_falls_unless_its_motion_is_limited() {
    for hz in [120.0, 240.0, 480.0] {
        let [limited, kept] = [Scheme::Substepped, Scheme::Verlet].map(|scheme| energies(scheme, 1.0 / hz));
        println!("{hz} Hz: limited at most {:.4}, in the end {:.1e}; not limited at most {:.0}", limited[0], limited[1], kept[0]);
        assert!(limited[0] < 1.01 && limited[1] < 1e-8, "limited: {limited:?}");
        assert!(kept[0] > 50.0, "not limited: {kept:?}");
    }
}
