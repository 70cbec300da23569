//! Blades in a recorded gust: error of their tips after a second against the time that its steps take.

use std::hint::black_box;
use std::time::Instant;

use anyhow::Result;
use shared::plant::blade::propagator::stable_dt_secs;
use shared::plant::blade::{Blade, Integrator, LINKS, Leans, Sway, abreast};

use super::super::{Outcome, Problem, Run};
use crate::norms::Norms;
use crate::problems::plants::{ABREAST, BLADE, Gust, PLACES};

/// Steps in the second: 1/15 s to 1/960 s, and two more for what fails on those.
const STEPS: [usize; 9] = [15, 30, 60, 120, 240, 480, 960, 1920, 3840];

const INTEGRATORS: [(&str, Integrator); 3] =
    [("Euler (000 Eq. 6)", Integrator::Euler), ("Verlet (000 Eq. 7)", Integrator::Verlet), ("exact", Integrator::Exact)];

pub(super) fn problem(quick: bool) -> Problem {
    let run = |(name, integrator): (&str, Integrator), steps: usize| Run {
        method: name.into(),
        cells: [PLACES, 1, 1],
        dt_secs: 1.0 / steps as f64,
        solve: Box::new(move || blow(integrator, steps)),
    };
    // Drag damps too, and with it Verlet's limit is lower than that of the still blade.
    let bears = |integrator: Integrator, steps: usize| {
        let limit_secs = stable_dt_secs(integrator, BLADE.frequency_rad_per_s, BLADE.damping_share);
        1.0 / steps as f32 <= 0.9 * limit_secs && (steps <= 960 || integrator == Integrator::Euler)
    };
    let counts = &STEPS[..STEPS.len() - usize::from(quick)];
    let runs = |method: (&'static str, Integrator)| {
        counts.iter().filter(move |&&steps| bears(method.1, steps)).map(move |&steps| run(method, steps))
    };
    Problem {
        name: "Blades in a gust",
        error: "error of the tip after a second (share of the length, root mean square)",
        per: "blade and simulated second",
        runs: INTEGRATORS.into_iter().flat_map(runs).collect(),
    }
}

fn blow(integrator: Integrator, steps: usize) -> Result<Outcome> {
    let gust = Gust::recorded();
    gust.check()?;
    let winds = gust.abreast(steps);
    let Blade { length_m, frequency_rad_per_s, damping_share, lean_per_wind2 } = BLADE;
    let [length_m, frequency_rad_per_s, damping_share, lean_per_wind2] =
        [length_m, frequency_rad_per_s, damping_share, lean_per_wind2].map(|value| [value; ABREAST]);
    let blade = Blade { length_m, frequency_rad_per_s, damping_share, lean_per_wind2 };
    let held: Leans<[f32; ABREAST]> = [[[0.0; ABREAST]; 2]; LINKS];
    let dt_secs = 1.0 / steps as f32;
    let begun = Instant::now();
    let sways: Vec<Sway<[f32; ABREAST]>> = winds
        .chunks(steps)
        .map(|winds| {
            let mut sway = Sway { lean_rad: held, rate_rad_per_s: held };
            winds.iter().for_each(|wind| abreast::advance(&mut sway, &blade, &held, wind, integrator, dt_secs));
            sway
        })
        .collect();
    let wall = begun.elapsed();
    let tips = black_box(sways).into_iter().flat_map(|sway| {
        (0..ABREAST).map(move |n| Sway::at_rest(sway.lean_rad.map(|link| link.map(|part| part[n]))).points_m(BLADE.length_m)[LINKS - 1])
    });
    let errors = tips.zip(gust.tips_m()).map(|(tip, wanted)| {
        let apart_m = (0..3).map(|axis| f64::from(tip[axis] - wanted[axis]).powi(2)).sum::<f64>().sqrt();
        (apart_m / f64::from(BLADE.length_m), 0.0)
    });
    Ok(Outcome { error: Norms::of(errors), simulated_secs: PLACES as f64, wall })
}
