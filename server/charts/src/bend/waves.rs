//! Error against time: a standing wave and a pulse against their exact solutions, a car against short steps.

use std::sync::OnceLock;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result};
use prairie_core::bend::limits::substeps;
use prairie_core::bend::{Damping, Edges, Field, Kinds, Rest, Scheme, Serial, WaveParams};
use prairie_core::grid::PatchLayout;

use super::super::{Outcome, Problem, Run};
use crate::norms::Norms;
use crate::problems::bend::{Mode, OneGrid, Oscillation, Pulse, Striker, alike, cells, start};

const WIDTH_M: f64 = 16.0;
const SPEED_M_PER_S: f64 = 2.0;
const DAMPING_PER_S: f64 = 0.8;
const STIFFNESS_PER_S2: f64 = 1.5;

/// A scheme and the Courant number of its steps; `None` for a single step to the end.
type Method = (&'static str, Scheme, Option<f64>);

const METHODS: [Method; 6] = [
    ("Chen & Johan, r = 0.6", Scheme::Verlet, Some(0.6)),
    ("sub-stepped, r = 0.6", Scheme::Substepped, Some(0.6)),
    ("sub-stepped, r = 2.4", Scheme::Substepped, Some(2.4)),
    ("implicit, r = 0.6", Scheme::Implicit, Some(0.6)),
    ("implicit, r = 2.4", Scheme::Implicit, Some(2.4)),
    ("modal, one step", Scheme::Modal, None),
];

/// Runs of every method on every grid; `error` sets the initial state and compares the end.
fn runs(counts: &'static [usize], end_secs: f64, error: fn(usize, Scheme, [f64; 2]) -> Result<Outcome>) -> Vec<Run> {
    let run = |(name, scheme, courant): Method, count: usize| {
        let longest_secs = courant.map_or(end_secs, |r| r * WIDTH_M / count as f64 / SPEED_M_PER_S);
        let dt_secs = end_secs / (end_secs / longest_secs).ceil();
        let solve = Box::new(move || error(count, scheme, [end_secs, dt_secs]));
        Run { method: name.into(), cells: [count, 1, count], dt_secs, solve }
    };
    METHODS.into_iter().flat_map(|method| counts.iter().map(move |&count| run(method, count))).collect()
}

/// Runs all steps and compares θ with the exact values, row by row.
fn outcome(mut field: Field, scheme: Scheme, [end_secs, dt_secs]: [f64; 2], exact: impl Fn([usize; 2]) -> f64) -> Result<Outcome> {
    let steps = (end_secs / dt_secs).round() as u32;
    let begun = Instant::now();
    for _ in 0..steps {
        field.step(scheme, dt_secs as f32, &Serial)?;
    }
    let wall = begun.elapsed();
    let error = Norms::of(cells(&field).map(|(cell, [now, _])| (f64::from(now.theta), exact(cell))));
    Ok(Outcome { error, simulated_secs: end_secs, wall })
}

/// Time between the two initial states of a field (s): one sub-step, so that no state has to be shifted.
fn start_secs(field: &Field, scheme: Scheme, dt_secs: f64) -> Result<f64> {
    let count = match scheme {
        Scheme::Substepped => substeps(field.kinds().waves(), field.layout().cell_m, dt_secs as f32, 0.0, Damping::Exact),
        _ => Some(1),
    };
    Ok(dt_secs / f64::from(count.context("too many sub-steps")?))
}

fn field(count: usize, cell_m: f64, edges: Edges) -> Field {
    let layout = PatchLayout { count: [2; 2], cells: count as u32 / 2, cell_m: cell_m as f32 };
    Field::new(layout, Kinds::one(alike(SPEED_M_PER_S as f32, DAMPING_PER_S as f32, STIFFNESS_PER_S2 as f32))).with_edges(edges)
}

/// A damped, stiff standing wave between free edges, for 1.25 periods.
pub(super) fn standing(quick: bool) -> Problem {
    const MODE: Mode = Mode { edges: Edges::Free, waves: [3, 2] };
    const WAVE: fn() -> Oscillation = || {
        let wave_number2 = MODE.wave_number2_per_m2([16; 2], MODE.cell_m(WIDTH_M, 16));
        Oscillation { damping_per_s: DAMPING_PER_S, stiffness_per_s2: SPEED_M_PER_S.powi(2) * wave_number2 + STIFFNESS_PER_S2 }
    };
    let error = |count: usize, scheme: Scheme, times: [f64; 2]| {
        let (wave, size) = (WAVE(), [count; 2]);
        let mut field = field(count, MODE.cell_m(WIDTH_M, count), MODE.edges);
        let before_secs = start_secs(&field, scheme, times[1])?;
        start(&mut field, before_secs, |cell| [0.0, -before_secs].map(|secs| MODE.shape(size, cell) * wave.at(secs)));
        outcome(field, scheme, times, |cell| MODE.shape(size, cell) * wave.at(times[0]))
    };
    let end_secs = 1.25 * std::f64::consts::TAU / WAVE().frequency_rad_per_s();
    let counts: &[usize] = if quick { &[16, 32, 64] } else { &[16, 32, 64, 128, 256] };
    Problem {
        name: "Standing wave",
        error: "rms error of θ (rad)",
        per: "simulated second",
        default_method: Some("sub-stepped"),
        cell_bytes: 12,
        runs: runs(counts, end_secs, error),
    }
}

/// A pulse that spreads far from any edge.
pub(super) fn pulse(quick: bool) -> Problem {
    let error = |count: usize, scheme: Scheme, times: [f64; 2]| {
        let pulse = Pulse {
            height_rad: 1.0,
            width_m: 1.0,
            speed_m_per_s: SPEED_M_PER_S,
            damping_per_s: DAMPING_PER_S,
            stiffness_per_s2: STIFFNESS_PER_S2,
        };
        let cell_m = WIDTH_M / count as f64;
        let mut field = field(count, cell_m, Edges::Rest);
        let before_secs = start_secs(&field, scheme, times[1])?;
        let [first, before, last] = [0.0, -before_secs, times[0]].map(|secs| pulse.on_grid(count, cell_m, secs));
        start(&mut field, before_secs, |[i, j]| [&first, &before].map(|state| state[j * count + i]));
        outcome(field, scheme, times, |[i, j]| last[j * count + i])
    };
    let counts: &[usize] = if quick { &[16, 32, 64] } else { &[16, 32, 64, 128] };
    Problem {
        name: "Pulse",
        error: "rms error of θ (rad)",
        per: "simulated second",
        default_method: Some("sub-stepped"),
        cell_bytes: 12,
        runs: runs(counts, 1.2, error),
    }
}

const TICK_SECS: f64 = 1.0 / 60.0;
const TICKS: u32 = 60;

/// Grass whose wave speed follows the bend: up to 16 m/s at 67 rad/s.
const FOLLOWING: WaveParams = WaveParams {
    c0_m_per_s: 2.0,
    mu_m_per_rad: 0.2,
    c_omega_m_per_s: 2.0,
    theta_damping_per_s: 3.0,
    omega_damping_per_s: 6.0,
    stiffness_per_s2: 1.2,
};

fn car_at(tick: u32) -> Striker {
    let at_m = [-10.0 + 20.0 * TICK_SECS as f32 * tick as f32, 1.0];
    Striker { at_m, velocity_m_per_s: [20.0, 0.0], radius_m: 1.0, strike_height_m: 0.3 }
}

fn meadow() -> Field {
    let layout = PatchLayout { count: [2; 2], cells: 32, cell_m: 0.4572 };
    let mut field = Field::new(layout, Kinds::one(FOLLOWING)).with_rest(Rest::EXACT);
    field.wake_all();
    field
}

/// A car at 20 m/s that presses 60 times a second, against a run in double precision with very short steps.
pub(super) fn car(quick: bool) -> Problem {
    let methods = [("Chen & Johan", Scheme::Verlet), ("sub-stepped", Scheme::Substepped), ("implicit", Scheme::Implicit)];
    let counts: &[u32] = if quick { &[1, 2, 4] } else { &[1, 2, 4, 8, 16] };
    let run = |(name, scheme): (&str, Scheme), steps: u32| {
        let solve = Box::new(move || {
            let (mut field, mut wall) = (meadow(), Duration::ZERO);
            for tick in 0..TICKS {
                car_at(tick).press(&mut field, TICK_SECS as f32);
                let begun = Instant::now();
                for _ in 0..steps {
                    field.step(scheme, TICK_SECS as f32 / steps as f32, &Serial)?;
                }
                wall += begun.elapsed();
            }
            let reference = reference(quick);
            let pairs = cells(&field).map(|(cell, [now, _])| (f64::from(now.theta), f64::from(reference.bend(cell).theta)));
            Ok(Outcome { error: Norms::of(pairs), simulated_secs: f64::from(TICKS) * TICK_SECS, wall })
        });
        Run { method: name.into(), cells: [64, 1, 64], dt_secs: TICK_SECS / f64::from(steps), solve }
    };
    let runs = methods.into_iter().flat_map(|method| counts.iter().map(move |&steps| run(method, steps))).collect();
    Problem {
        name: "Car, speed by Eq 4",
        error: "rms error in time of θ (rad)",
        per: "simulated second",
        default_method: Some("sub-stepped"),
        cell_bytes: 12,
        runs,
    }
}

/// The reference run with very short steps; computed once.
fn reference(quick: bool) -> &'static OneGrid<f64> {
    static REFERENCE: OnceLock<OneGrid<f64>> = OnceLock::new();
    REFERENCE.get_or_init(|| {
        let mut grid = OneGrid::like(&meadow(), Edges::Rest);
        for tick in 0..TICKS {
            car_at(tick).press_grid(&mut grid, TICK_SECS as f32);
            grid.step(Damping::Exact, if quick { 32 } else { 256 }, TICK_SECS as f32);
        }
        grid
    })
}
