//! Dust in rotating air, by each advection scheme.

use prairie_wind::Advection;

use super::super::{Outcome, Problem, Run};
use super::{COURANT, Steps};
use crate::norms::Norms;
use crate::problems::{RotatingGaussian, Rotation, SlottedDisc};
use crate::turntable::{SOLID_RADIUS, turntable};

const ROTATION: Rotation = Rotation { side_m: 100.0, period_secs: 628.0 };

/// Zalesak's disc, one revolution.
pub(super) fn slotted_disc(cells: &[usize]) -> Problem {
    let disc = SlottedDisc(ROTATION);
    let mean = move |position, spacing_m| disc.mean_density(position, [spacing_m; 2], 8, 0.0);
    Problem {
        name: "Slotted disc",
        error: "rms error of density",
        per: "simulated second",
        default_method: Some("conservative"),
        cell_bytes: 8,
        runs: turned_once(cells, mean),
    }
}

/// A Gaussian hill, one revolution.
pub(super) fn rotating_gaussian(cells: &[usize]) -> Problem {
    let hill = RotatingGaussian { rotation: ROTATION, width: 0.04 };
    let density = move |position, _| hill.density(position, 0.0);
    Problem {
        name: "Rotating Gaussian",
        error: "rms error of density",
        per: "simulated second",
        default_method: Some("conservative"),
        cell_bytes: 8,
        runs: turned_once(cells, density),
    }
}

/// Dust with a density by position and spacing (m), which returns to its start after one revolution. Courant numbers refer to the speed at the edge of the
/// solid-body region.
fn turned_once(cells: &[usize], density: impl Fn([f64; 3], f64) -> f64 + Copy + 'static) -> Vec<Run> {
    let run = |advection: Advection, n: usize, courant: f64| {
        let spacing_m = ROTATION.side_m / n as f64;
        let [_, _, fastest_m_per_s] = ROTATION.velocity([(0.5 + SOLID_RADIUS) * ROTATION.side_m, 0.0, 0.5 * ROTATION.side_m]);
        let steps = Steps::new(ROTATION.period_secs, courant * spacing_m / fastest_m_per_s);
        let solve = move || {
            let mut air = turntable::<f64>(ROTATION, advection, n);
            air.set_dust(|position| density(position, spacing_m));
            let wall = steps.take(|dt_secs| air.step_dust(dt_secs))?;
            let turns = |[x, _, z]: [f64; 3]| (x / ROTATION.side_m - 0.5).hypot(z / ROTATION.side_m - 0.5) < SOLID_RADIUS;
            let compared = air.dust_samples().filter(|(position, _)| turns(*position));
            let error = Norms::of(compared.map(|(position, found)| (found, density(position, spacing_m))));
            Ok(Outcome { error, simulated_secs: ROTATION.period_secs, wall })
        };
        Run {
            method: format!("{}, Courant {courant}", advection.label()),
            cells: [n, 1, n],
            dt_secs: steps.dt_secs,
            solve: Box::new(solve),
        }
    };
    let lines = Advection::ALL.iter().flat_map(|&scheme| COURANT.map(|courant| (scheme, courant)));
    lines.flat_map(|(scheme, courant)| cells.iter().map(move |&n| run(scheme, n, courant))).collect()
}
