//! Blades in a recorded gust: error of their tips after a second against the computing time.

use std::hint::black_box;
use std::time::Instant;

use anyhow::Result;
use prairie_core::plant::blade::propagator::stable_dt_secs;
use prairie_core::plant::blade::{Integrator, LINKS, Leans, Sway, advance};

use super::super::{Outcome, Problem, Run};
use crate::norms::Norms;
use crate::problems::plants::{BLADE, Gust, PLACES};

/// Steps per second: time steps of 1/15 s to 1/960 s, and two shorter ones for integrators that are unstable at those.
const STEPS: [usize; 9] = [15, 30, 60, 120, 240, 480, 960, 1920, 3840];

const INTEGRATORS: [(&str, Integrator); 3] =
    [("Euler (Zhang, Eq. 6)", Integrator::Euler), ("Verlet (Zhang, Eq. 7)", Integrator::Verlet), ("exact", Integrator::Exact)];

pub(super) fn problem(quick: bool) -> Problem {
    let run = |(name, integrator): (&str, Integrator), steps: usize| Run {
        method: name.into(),
        cells: [PLACES, 1, 1],
        dt_secs: 1.0 / steps as f64,
        solve: Box::new(move || blow(integrator, steps)),
    };
    // Drag adds damping, which lowers Verlet's limit below that of a blade in still air.
    let bears = |integrator: Integrator, steps: usize| {
        let limit_secs = stable_dt_secs(integrator, BLADE.frequency_rad_per_s, BLADE.damping_ratio);
        1.0 / steps as f32 <= 0.9 * limit_secs && (steps <= 960 || integrator == Integrator::Euler)
    };
    let counts = &STEPS[..STEPS.len() - usize::from(quick)];
    let runs = |method: (&'static str, Integrator)| {
        counts.iter().filter(move |&&steps| bears(method.1, steps)).map(move |&steps| run(method, steps))
    };
    Problem {
        name: "Tip in a gust",
        error: "error of the tip after a second (fraction of the length, root mean square)",
        per: "blade and simulated second",
        default_method: Some("exact"),
        cell_bytes: 0,
        runs: INTEGRATORS.into_iter().flat_map(runs).collect(),
    }
}

fn blow(integrator: Integrator, steps: usize) -> Result<Outcome> {
    let gust = Gust::recorded();
    gust.check()?;
    let winds = gust.winds_m_per_s(steps);
    let (held, dt_secs) = (Leans::default(), 1.0 / steps as f32);
    let begun = Instant::now();
    let step = |sway: Sway, wind: &Leans| advance(&sway, &BLADE, &held, wind, integrator, dt_secs);
    let sways: Vec<Sway> = winds.iter().map(|winds| winds.iter().fold(Sway::at_rest(held), step)).collect();
    let wall = begun.elapsed();
    let tips = black_box(sways).into_iter().map(|sway| sway.points_m(BLADE.length_m)[LINKS - 1]);
    let errors = tips.zip(gust.tips_m()).map(|(tip, wanted)| {
        let apart_m = (0..3).map(|axis| f64::from(tip[axis] - wanted[axis]).powi(2)).sum::<f64>().sqrt();
        (apart_m / f64::from(BLADE.length_m), 0.0)
    });
    Ok(Outcome { error: Norms::of(errors), simulated_secs: PLACES as f64, wall })
}
