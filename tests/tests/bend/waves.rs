//! The waves of the bend field against exact solutions: standing modes, a spreading pulse, frequency and decay, energy.
//!
//! All tests use a field of several patches and check all three channels.

use std::f64::consts::TAU;

use prairie_charts::norms::{Norms, fitted_order};
use prairie_charts::problems::bend::{
    Energy, FACTORS, Mode, Oscillation, Pulse, Recurrence, Steps, alike, cells, channels, largest_difference, start,
};
use prairie_core::bend::{CHANNELS, Edges, Field, Kinds, Scheme, Serial};
use prairie_core::grid::PatchLayout;

const WIDTH_M: f64 = 16.0;
const SPEED_M_PER_S: f32 = 2.0;
const EDGES: [Edges; 3] = [Edges::Rest, Edges::Free, Edges::Wrapped];

/// Damping rate (1/s) and stiffness (1/s²): neither, either, both.
const CONSTANTS: [[f32; 2]; 4] = [[0.0, 0.0], [0.8, 0.0], [0.0, 1.5], [0.8, 1.5]];

/// A square world of 4 patches at least, all awake.
fn field(mode: Mode, count: usize, [damping, stiffness]: [f32; 2]) -> Field {
    let side = if count.is_multiple_of(16) { count / 2 } else { 8 };
    let cell_m = mode.cell_m(WIDTH_M, count) as f32;
    let layout = PatchLayout { count: [(count / side) as u32; 2], cells: side as u32, cell_m };
    Field::new(layout, Kinds::one(alike(SPEED_M_PER_S, damping, stiffness))).with_edges(mode.edges)
}

fn oscillation(wave_number2_per_m2: f64, [damping, stiffness]: [f32; 2]) -> Oscillation {
    let speed = f64::from(SPEED_M_PER_S);
    Oscillation { damping_per_s: damping.into(), stiffness_per_s2: speed * speed * wave_number2_per_m2 + f64::from(stiffness) }
}

/// Reference solution of a standing wave.
#[derive(Clone, Copy, PartialEq)]
enum Exact {
    Continuum,
    /// The five-point differences: only time is in error.
    Grid,
}

/// Error of a standing wave in all channels after a number of periods, relative to the damped amplitude. A quarter period at the end is most sensitive to
/// the phase.
fn mode_error(scheme: Scheme, mode: Mode, count: usize, constants: [f32; 2], exact: Exact, [turns, longest_dt_secs]: [f64; 2]) -> Norms {
    let (size, cell_m) = ([count; 2], mode.cell_m(WIDTH_M, count));
    let wave_number2 = match exact {
        Exact::Continuum => mode.wave_number2_per_m2(size, cell_m),
        Exact::Grid => mode.grid_wave_number2_per_m2(size, cell_m),
    };
    let wave = oscillation(wave_number2, constants);
    let mut field = field(mode, count, constants);
    let end_secs = turns * TAU / wave.frequency_rad_per_s();
    let steps = (end_secs / longest_dt_secs).ceil().max(1.0);
    let dt_secs = end_secs / steps;
    start(&mut field, dt_secs, |cell| [0.0, -dt_secs].map(|secs| mode.shape(size, cell) * wave.at(secs)));
    for _ in 0..steps as u32 {
        let report = field.step(scheme, dt_secs as f32, &Serial).unwrap();
        assert_eq!(report.substeps, 1, "the step itself is refined");
    }
    let left = (-0.5 * wave.damping_per_s * end_secs).exp();
    let pairs = cells(&field).flat_map(|(cell, [now, _])| {
        let exact = mode.shape(size, cell) * wave.at(end_secs) / left;
        (0..CHANNELS).map(move |channel| (f64::from(channels(now)[channel]) / (left * FACTORS[channel]), exact))
    });
    Norms::of(pairs)
}

fn assert_order(what: &str, expected: f64, errors: &[(f64, Norms)]) {
    for (norm, pick) in [("L1", (|n| n.l1) as fn(&Norms) -> f64), ("L2", |n| n.l2), ("Linf", |n| n.linf)] {
        let points: Vec<_> = errors.iter().map(|(size, norms)| (*size, pick(norms))).collect();
        let order = fitted_order(&points);
        println!("{what}, {norm}: order {order:.2}, least error {:.1e}", points.last().unwrap().1);
        assert!((order - expected).abs() < 0.15, "{what}, {norm}: order {order:.2} for {expected} from {points:?}");
    }
}

const SCHEMES: [Scheme; 2] = [Scheme::Substepped, Scheme::Implicit];

#[test]
fn standing_waves_converge_at_second_order_in_space_and_time() {
    for edges in EDGES {
        let mode = Mode { edges, waves: if edges == Edges::Wrapped { [2, 1] } else { [3, 2] } };
        for constants in CONSTANTS {
            for scheme in SCHEMES {
                let error = |count: usize| {
                    let cell_m = mode.cell_m(WIDTH_M, count);
                    (cell_m, mode_error(scheme, mode, count, constants, Exact::Continuum, [1.25, 0.15 * cell_m]))
                };
                assert_order(&format!("{scheme:?}, {edges:?}, {constants:?}, dt in proportion to h"), 2.0, &[16, 32, 64].map(error));
            }
        }
    }
}

#[test]
fn the_modal_scheme_has_only_a_spatial_error_of_second_order() {
    for edges in EDGES {
        let mode = Mode { edges, waves: if edges == Edges::Wrapped { [2, 1] } else { [3, 2] } };
        // One long step to the end.
        let error = |count| {
            (mode.cell_m(WIDTH_M, count), mode_error(Scheme::Modal, mode, count, [0.8, 1.5], Exact::Continuum, [1.25, f64::INFINITY]))
        };
        assert_order(&format!("Modal, {edges:?}, h"), 2.0, &[16, 24, 32, 48].map(error));
    }
}

#[test]
fn standing_waves_converge_in_time_on_a_fixed_grid() {
    let mode = Mode { edges: Edges::Rest, waves: [3, 2] };
    for constants in CONSTANTS {
        for scheme in [Scheme::Verlet, Scheme::Substepped, Scheme::Implicit] {
            // Chen & Johan apply the full force although damping has already slowed the motion: an error of first order.
            let formal = if scheme == Scheme::Verlet && constants[0] > 0.0 { 1.0 } else { 2.0 };
            let error = |dt_secs| (dt_secs, mode_error(scheme, mode, 16, constants, Exact::Grid, [1.25, dt_secs]));
            assert_order(&format!("{scheme:?}, {constants:?}, dt"), formal, &[0.15, 0.075, 0.0375].map(error));
        }
    }
}

#[test]
fn the_modal_scheme_is_exact_in_time() {
    for edges in EDGES {
        for waves in [[1, 1], [5, 3], [13, 11]] {
            let mode = Mode { edges, waves: if edges == Edges::Wrapped { waves.map(|n| n / 2 + 1) } else { waves } };
            for constants in CONSTANTS {
                // In a single step, in long ones, and in short ones, whose rounding errors add up.
                for (longest_dt_secs, allowed) in [(f64::INFINITY, 1e-5), (0.7, 1e-5), (1.0 / 60.0, 5e-5)] {
                    let Norms { l2, linf, .. } = mode_error(Scheme::Modal, mode, 24, constants, Exact::Grid, [2.25, longest_dt_secs]);
                    println!("{edges:?}, {waves:?}, {constants:?}, steps of at most {longest_dt_secs} s: rms {l2:.1e}, largest {linf:.1e}");
                    assert!(linf < allowed, "{edges:?}, {waves:?}, {constants:?}, steps of at most {longest_dt_secs} s: {linf}");
                }
            }
        }
    }
}

/// Error of a pulse in the middle of a field, far from its edges.
fn pulse_error(scheme: Scheme, pulse: &Pulse, count: usize, [end_secs, dt_secs]: [f64; 2], exact: &[f64]) -> Norms {
    let cell_m = WIDTH_M / count as f64;
    let layout = PatchLayout { count: [4; 2], cells: count as u32 / 4, cell_m: cell_m as f32 };
    let waves = alike(pulse.speed_m_per_s as f32, pulse.damping_per_s as f32, pulse.stiffness_per_s2 as f32);
    let mut field = Field::new(layout, Kinds::one(waves));
    let steps = (end_secs / dt_secs).round();
    let dt_secs = end_secs / steps;
    let states = [0.0, -dt_secs].map(|secs| pulse.on_grid(count, cell_m, secs));
    start(&mut field, dt_secs, |[i, j]| states.each_ref().map(|state| state[j * count + i]));
    for _ in 0..steps as u32 {
        assert_eq!(field.step(scheme, dt_secs as f32, &Serial).unwrap().substeps, 1);
    }
    Norms::of(cells(&field).flat_map(|([i, j], [now, _])| {
        let exact = exact[j * count + i];
        (0..CHANNELS).map(move |channel| (f64::from(channels(now)[channel]) / FACTORS[channel], exact))
    }))
}

#[test]
fn a_pulse_spreads_as_in_the_continuum() {
    for [damping_per_s, stiffness_per_s2] in [[0.0, 0.0], [0.8, 1.5]] {
        let pulse = Pulse { height_rad: 1.0, width_m: 1.0, speed_m_per_s: 2.0, damping_per_s, stiffness_per_s2 };
        const END_SECS: f64 = 1.2;
        let counts = [32, 64, 128];
        let exact = counts.map(|count| pulse.on_grid(count, WIDTH_M / count as f64, END_SECS));
        for scheme in [Scheme::Substepped, Scheme::Implicit, Scheme::Modal] {
            let error = |n: usize| {
                let cell_m = WIDTH_M / counts[n] as f64;
                // The modal scheme takes one step.
                let dt_secs = if scheme == Scheme::Modal { END_SECS } else { 0.2 * cell_m };
                (cell_m, pulse_error(scheme, &pulse, counts[n], [END_SECS, dt_secs], &exact[n]))
            };
            assert_order(&format!("pulse, {scheme:?}, k = {damping_per_s}"), 2.0, &[0, 1, 2].map(error));
        }
    }
}

#[test]
fn a_pulse_converges_in_time_to_the_exact_modes_of_its_grid() {
    const END_SECS: f64 = 1.2;
    let layout = PatchLayout { count: [3, 2], cells: 16, cell_m: 0.4 };
    let run = |scheme: Scheme, steps: u32| {
        let mut field = Field::new(layout, Kinds::one(alike(2.0, 0.8, 1.5))).with_edges(Edges::Free);
        let dt_secs = END_SECS / f64::from(steps);
        let far_m = |[i, j]: [usize; 2]| (0.4 * i as f64 - 5.0).hypot(0.4 * j as f64 - 7.0);
        start(&mut field, dt_secs, |cell| [(-0.5 * far_m(cell).powi(2)).exp(); 2]);
        (0..steps).for_each(|_| assert_eq!(field.step(scheme, dt_secs as f32, &Serial).unwrap().substeps, 1));
        field
    };
    for scheme in SCHEMES {
        let errors = [12, 24, 48].map(|steps| {
            let [most, apart] = largest_difference(&run(scheme, steps), &run(Scheme::Modal, steps));
            println!("{scheme:?}, {steps} steps: {apart:.2e} of {most:.2}");
            (END_SECS / f64::from(steps), f64::from(apart))
        });
        let order = fitted_order(&errors);
        assert!((order - 2.0).abs() < 0.15, "{scheme:?}: {order:.2} from {errors:?}");
    }
}

/// Exact recurrence of a mode, and those fitted to the measured channels.
fn measured(scheme: Scheme, mode: Mode, count: usize, constants: [f32; 2], dt_secs: f64) -> [Recurrence; 1 + CHANNELS] {
    let (size, cell_m) = ([count; 2], mode.cell_m(WIDTH_M, count));
    let steps = Steps {
        damping: f64::from(constants[0]) * dt_secs,
        restoring: f64::from(constants[1]) * dt_secs * dt_secs,
        courant: f64::from(SPEED_M_PER_S) * dt_secs / cell_m,
        differences: mode.differences(size),
    };
    let exact = Recurrence::of(scheme, &steps);
    let mut field = field(mode, count, constants);
    // In motion from the start: a(−1) = cos φ.
    start(&mut field, dt_secs, |cell| [1.0, exact.phase_rad().cos()].map(|amplitude| amplitude * mode.shape(size, cell)));
    let norm: f64 = cells(&field).map(|(cell, _)| mode.shape(size, cell).powi(2)).sum();
    let mut series = [const { vec![] }; CHANNELS];
    for _ in 0..120 {
        for (channel, series) in series.iter_mut().enumerate() {
            let project = |(cell, [now, _]): (_, [_; 2])| f64::from(channels(now)[channel]) * mode.shape(size, cell);
            series.push(cells(&field).map(project).sum::<f64>() / norm);
        }
        assert_eq!(field.step(scheme, dt_secs as f32, &Serial).unwrap().substeps, 1);
    }
    let [theta, x, z] = series.map(|series| Recurrence::fitted(&series));
    [exact, theta, x, z]
}

#[test]
fn frequency_and_decay_match_the_discrete_dispersion_relation() {
    const COUNT: usize = 16;
    // Along an axis, oblique, the shortest along one axis, the checkerboard; whole waves between wrapped edges, half ones between others.
    let wrapped = [[1, 0], [2, 0], [0, 3], [1, 1], [2, 1], [3, 5], [4, 4], [7, 2], [8, 0], [0, 8], [8, 3], [8, 8]];
    let modes = wrapped.map(|waves| Mode { edges: Edges::Wrapped, waves }).into_iter();
    let modes = modes.chain([[1, 1], [5, 2], [16, 16]].map(|waves| Mode { edges: Edges::Rest, waves }));
    let modes: Vec<_> = modes.chain([[1, 0], [7, 4], [15, 15]].map(|waves| Mode { edges: Edges::Free, waves })).collect();
    println!("{:<8} {:<10} {:<9} {:>9} {:>9} {:>9} {:>9}", "edges", "scheme", "waves", "ω (rad/s)", "off by", "k/2 (1/s)", "off by");
    for &scheme in Scheme::ALL {
        for &mode in &modes {
            // Explicit schemes below the limit; the others at more than twice that step.
            let dt_secs = if matches!(scheme, Scheme::Verlet | Scheme::Substepped) { 0.3 } else { 0.8 };
            let [exact, found @ ..] = measured(scheme, mode, COUNT, [0.4, 1.5], dt_secs);
            let rates = |recurrence: &Recurrence| [recurrence.phase_rad() / dt_secs, recurrence.decay() / dt_secs];
            let [frequency, decay] = rates(&exact);
            for found in found {
                let [found_frequency, found_decay] = rates(&found);
                let off = [found_frequency / frequency - 1.0, found_decay / decay - 1.0];
                println!(
                    "{:<8} {:<10} {:<9} {frequency:>9.5} {:>9.1e} {decay:>9.5} {:>9.1e}",
                    format!("{:?}", mode.edges),
                    format!("{scheme:?}"),
                    format!("{:?}", mode.waves),
                    off[0],
                    off[1]
                );
                assert!(off.iter().all(|off| off.abs() < 1e-4), "{scheme:?}, {mode:?}: {off:?} of {frequency} rad/s and {decay} 1/s");
            }
        }
    }
}

/// Reproducible noise.
fn noise([i, j]: [usize; 2]) -> f64 {
    let mixed = ((i as u32 * 0x9E37_79B1) ^ (j as u32 * 0x85EB_CA77)).wrapping_mul(0xC2B2_AE3D);
    f64::from(mixed ^ (mixed >> 15)) / f64::from(u32::MAX) - 0.5
}

#[test]
fn undamped_energy_is_constant_over_ten_thousand_steps() {
    for edges in EDGES {
        for (scheme, courant, stiffness) in
            [(Scheme::Substepped, 0.5, 0.0), (Scheme::Substepped, 0.6, 1.5), (Scheme::Implicit, 0.5, 0.0), (Scheme::Implicit, 3.0, 1.5)]
        {
            let mut field = field(Mode { edges, waves: [1, 1] }, 16, [0.0, stiffness]);
            let courant_dt_secs = courant * field.layout().cell_m / SPEED_M_PER_S;
            let dt_secs = f64::from(courant_dt_secs);
            let energy = Energy { courant: f64::from(courant), restoring: f64::from(stiffness) * dt_secs * dt_secs, edges };
            // Without a mean speed, which would turn free grass round and round.
            let mean: f64 = (0..256).map(|n| noise([n % 16, n / 16]) - noise([n / 16 + 99, n % 16])).sum::<f64>() / 256.0;
            start(&mut field, dt_secs, |cell| [noise(cell) - mean, noise([cell[1] + 99, cell[0]])]);
            let first = energy.of(&field, scheme);
            let mut farthest = [0.0f64; CHANNELS];
            for step in 1..=10_000 {
                assert_eq!(field.step(scheme, courant_dt_secs, &Serial).unwrap().substeps, 1);
                if step % 100 == 0 {
                    let now = energy.of(&field, scheme);
                    (0..CHANNELS).for_each(|n| farthest[n] = farthest[n].max((now[n] / first[n] - 1.0).abs()));
                }
            }
            println!("{edges:?}, {scheme:?}, r = {courant}, κ = {stiffness}: off by {farthest:?}");
            assert!(farthest.iter().all(|off| *off < 1e-5), "{edges:?}, {scheme:?}, r = {courant}: {farthest:?}");
        }
    }
}
