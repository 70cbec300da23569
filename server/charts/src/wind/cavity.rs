//! The lid-driven cavity.

use std::time::{Duration, Instant};

use anyhow::Result;
use prairie_wind::{Boundary, Config, Solver};

use super::super::{Outcome, Problem, Run};
use super::{COURANT, Choice, METHODS};
use crate::air::still_air;
use crate::norms::Norms;
use crate::problems::Cavity;

/// Largest change of a velocity in a second (m/s; the lid's is 1) at which the flow counts as steady.
const STEADY_M_PER_S: f64 = 2e-4;
/// Time limit (s) for reaching the steady state; some methods never do.
const LONGEST_SECS: f64 = 40.0;

/// The flow in a square of 1 m under a lid of 1 m/s, once it is steady, against a table on both centrelines. Errors below those of the table are not meaningful.
pub(super) fn cavity(name: &'static str, table: &'static Cavity, cells: &[usize]) -> Problem {
    let mut runs = Vec::new();
    for choice in METHODS {
        for courant in COURANT {
            runs.extend((0..cells.len()).map(|finest| run(table, choice, cells[..=finest].to_vec(), courant)));
        }
    }
    Problem {
        name,
        error: "rms difference from the table (of the lid's speed)",
        per: "simulated second",
        default_method: Some("conservative, damping 1"),
        cell_bytes: 24,
        runs,
    }
}

/// Starts each grid from the steady flow on the previous one; only the last is timed.
fn run(table: &'static Cavity, (name, choose): Choice, grids: Vec<usize>, courant: f64) -> Run {
    let finest = grids.last().copied().unwrap_or(1);
    let steps_per_s = move |n: usize| (n as f64 / courant).ceil();
    let solve = move || {
        let mut coarser: Option<Settled> = None;
        for &n in &grids {
            let mut config = still_air([n, n, 1], [1.0 / n as f64; 3], faces());
            config.viscosity_m2_per_s = (1.0 / table.reynolds) as f32;
            choose(&mut config);
            coarser = Some(settle(&config, steps_per_s(n), coarser.as_ref().map(|settled| &settled.air))?);
        }
        let Settled { air, simulated_secs, wall } = coarser.expect("there is a grid");
        let at = |x: f64, y: f64| air.velocity_at([x, y, 0.5 / finest as f64]);
        let [u, v] = table.compare(|y| at(0.5, y)[0], |x| at(x, 0.5)[1]);
        let error = Norms { l1: 0.5 * (u.l1 + v.l1), l2: (0.5 * (u.l2 * u.l2 + v.l2 * v.l2)).sqrt(), linf: u.linf.max(v.linf) };
        Ok(Outcome { error, simulated_secs, wall })
    };
    Run {
        method: format!("{name}, Courant {courant}"),
        cells: [finest, finest, 1],
        dt_secs: steps_per_s(finest).recip(),
        solve: Box::new(solve),
    }
}

fn faces() -> [[Boundary; 2]; 3] {
    let lid = Boundary::Lid { velocity_m_per_s: [1.0, 0.0, 0.0] };
    [[Boundary::NoSlip; 2], [Boundary::NoSlip, lid], [Boundary::Wrap; 2]]
}

/// A steady flow, and the time to reach it.
struct Settled {
    air: Solver<f64>,
    simulated_secs: f64,
    wall: Duration,
}

fn settle(config: &Config, steps_per_s: f64, guess: Option<&Solver<f64>>) -> Result<Settled> {
    let mut air = Solver::<f64>::new(config)?;
    air.set_velocity(|position| guess.map_or([0.0; 3], |air| air.velocity_at(position)));
    let values = |air: &Solver<f64>| (0..2).flat_map(|axis| air.samples(axis).map(|(_, speed)| speed)).collect::<Vec<_>>();
    let (mut before, mut wall, mut simulated_secs) = (values(&air), Duration::ZERO, 0.0);
    loop {
        let start = Instant::now();
        for _ in 0..steps_per_s as usize {
            air.step(steps_per_s.recip(), &[])?;
        }
        wall += start.elapsed();
        simulated_secs += 1.0;
        let after = values(&air);
        let change_m_per_s = Norms::of(before.into_iter().zip(after.iter().copied())).linf;
        if change_m_per_s < STEADY_M_PER_S || simulated_secs >= LONGEST_SECS {
            return Ok(Settled { air, simulated_secs, wall });
        }
        before = after;
    }
}
