//! Waves of θ whose speed varies by Eq. (4), with the motion that they keep limited where it falls and without. Undamped, `Scheme::Verlet` and
//! `Scheme::Substepped` differ in nothing else.

use prairie_core::bend::{Bend, Edges, Field, Kinds, Scheme, Serial, WaveParams};
use prairie_core::grid::PatchLayout;
use tests::problems::bend::{cells, size};

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

/// Four patches with periodic edges that start with states of which only the later one is known, and the rates of change are zero.
fn started(dt_secs: f32, state: impl Fn(usize, usize) -> Bend) -> Field {
    let states: Vec<Bend> = (0..SIDE * SIDE).map(|n| state(n % SIDE, n / SIDE)).collect();
    let plane = |of: fn(&Bend) -> f32| states.iter().map(|state| f64::from(of(state))).collect::<Vec<_>>();
    let [theta, x, z] = [plane(|state| state.theta), plane(|state| state.omega[0]), plane(|state| state.omega[1])];
    let r2_omega = (f64::from(WAVES.c_omega_m_per_s) * f64::from(dt_secs) / f64::from(CELL_M)).powi(2);
    let mut field =
        Field::new(PatchLayout { count: [2, 2], cells: SIDE as u32 / 2, cell_m: CELL_M }, Kinds::one(WAVES)).with_edges(Edges::Wrapped);
    field.start(dt_secs, |at_m| {
        let [i, j] = at_m.map(|m| (m / CELL_M) as usize);
        let now = states[at(i, j)];
        let before = |plane: &[f64], r2: f64| (plane[at(i, j)] + 0.5 * r2 * laplacian(plane, i, j)) as f32;
        let r2_theta = courant(now.omega, dt_secs).powi(2);
        [now, Bend { theta: before(&theta, r2_theta), omega: [before(&x, r2_omega), before(&z, r2_omega)] }]
    });
    field
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

fn random(i: usize, j: usize, salt: u32) -> f32 {
    let mixed = ((i as u32 * 0x9E37_79B1) ^ (j as u32 * 0x85EB_CA77) ^ salt.wrapping_mul(0x27D4_EB2F)).wrapping_mul(0xC2B2_AE3D);
    (((mixed ^ (mixed >> 15)).wrapping_mul(0x2C1B_3C6D) >> 8) as f32) / 2.0f32.powi(23) - 1.0
}

/// Greatest energy relative to that at the start, and the last.
fn energies(scheme: Scheme, dt_secs: f32) -> [f64; 2] {
    const SECS: f32 = 20.0;
    let mut field = started(dt_secs, |i, j| Bend { theta: 0.1 * random(i, j, 1), omega: [5.0 * random(i, j, 2), 5.0 * random(i, j, 3)] });
    assert_eq!(size(&field), [SIDE; 2]);
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

/// Without a limit each fall of the speed adds `|v|²·(1/r² − 1/r⁻²)`, however short the steps.
#[test]
fn the_energy_of_a_wave_grows_where_its_speed_falls_unless_its_motion_is_limited() {
    for hz in [120.0, 240.0, 480.0] {
        let [limited, kept] = [Scheme::Substepped, Scheme::Verlet].map(|scheme| energies(scheme, 1.0 / hz));
        println!("{hz} Hz: limited at most {:.4}, in the end {:.1e}; not limited at most {:.0}", limited[0], limited[1], kept[0]);
        assert!(limited[0] < 1.01, "limited: {limited:?}");
        assert!(kept[0] > 50.0, "not limited: {kept:?}");
    }
}
