//! Runs of the wind solver: methods on problems with known solutions, from coarse to fine.
//!
//! | file | problems |
//! |---|---|
//! | `failures` | where transport by fluxes fails |
//! | `flows` | Taylor–Green, Ethier–Steinman: the whole solver |
//! | `cavity` | the lid-driven cavity at Re = 100 and 1000 |
//! | `dust` | Zalesak's disc and a rotating Gaussian: each advection scheme of dust |
//! | `heat` | the heat kernel: each diffusion scheme |
//! | `projection` | each pressure method: time against the remaining divergence |
//! | `honami` | waves over grass that sways and over rigid grass: frequency against the wind; a field of waves |
//! | `wakes` | vortices behind an immersed cylinder, and a vortex that leaves the box |
//!
//! All runs are in double precision, so that rounding hides nothing. Zhang's method supports neither moving lids nor prescribed faces: it takes part in
//! Taylor–Green and in the projection.

mod cavity;
mod dust;
mod failures;
mod flows;
mod heat;
mod honami;
mod projection;
mod wakes;

use std::time::{Duration, Instant};

use anyhow::Result;
use prairie_wind::{Advection, Config, StepError, TimeScheme};

use super::Problem;
use super::figure::Figure;
use crate::problems::{BOTELLA_PEYRET_RE_1000, GHIA_RE_100};

/// A named change of the default configuration.
type Choice = (&'static str, fn(&mut Config));

/// Methods for the whole solver. The last but one is the default.
const METHODS: [Choice; 6] = [
    ("semi-Lagrangian, split", |config| (config.advection, config.time) = (Advection::SemiLagrangian, TimeScheme::Split)),
    ("MacCormack, split", |config| (config.advection, config.time) = (Advection::MacCormack, TimeScheme::Split)),
    ("MacCormack, reflection", |config| (config.advection, config.time) = (Advection::MacCormack, TimeScheme::Reflection)),
    ("BFECC, reflection", |config| (config.advection, config.time) = (Advection::Bfecc, TimeScheme::Reflection)),
    ("conservative, damping 1", |config| config.damping = 1.0),
    ("conservative, damping 0", |config| config.damping = 0.0),
];

/// Courant numbers of each method, by the largest initial speed.
const COURANT: [f64; 2] = [0.5, 2.0];

/// All figures other than error against time.
pub const FIGURES: [Figure; 4] = [
    Figure { name: "lock-in", title: "Waves over grass are drawn to its own frequency", draw: honami::draw_lock_in },
    Figure { name: "honami", title: "Waves over a field", draw: honami::draw_field },
    Figure { name: "cylinder", title: "Vortices behind a cylinder", draw: wakes::draw_cylinder },
    Figure { name: "outflow", title: "A vortex leaves the box", draw: wakes::draw_outflow },
];

/// Figures of where methods fail.
pub const FAILURES: [Figure; 1] = [Figure { name: "failures", title: "Where transport by fluxes fails", draw: failures::draw }];

/// All problems; `quick` leaves out the finest grids.
pub fn problems(quick: bool) -> Vec<Problem> {
    let upto = |cells: &'static [usize], finest: usize| &cells[..if quick { finest } else { cells.len() }];
    let mut problems = vec![
        flows::taylor_green(upto(&[16, 32, 64, 128, 192], 3)),
        flows::ethier_steinman(upto(&[8, 16, 32, 48], 2)),
        cavity::cavity("Cavity, Re = 100", &GHIA_RE_100, upto(&[8, 16, 32], 2)),
        cavity::cavity("Cavity, Re = 1000", &BOTELLA_PEYRET_RE_1000, upto(&[16, 32, 48], 1)),
        dust::slotted_disc(upto(&[50, 100, 200], 1)),
        dust::rotating_gaussian(upto(&[50, 100, 200], 1)),
        heat::heat_kernel(upto(&[16, 32, 64, 128], 3)),
        projection::projection("Projection, 32³", 32),
    ];
    if !quick {
        problems.push(projection::projection("Projection, 64³", 64));
    }
    problems
}

/// Equal time steps up to a given time.
#[derive(Clone, Copy)]
struct Steps {
    number: usize,
    dt_secs: f64,
}

impl Steps {
    fn new(end_secs: f64, longest_secs: f64) -> Self {
        let number = (end_secs / longest_secs).ceil();
        Self { number: number as usize, dt_secs: end_secs / number }
    }

    /// Runs the steps and returns the elapsed time.
    fn take<T>(self, mut step: impl FnMut(f64) -> Result<T, StepError>) -> Result<Duration> {
        let start = Instant::now();
        for _ in 0..self.number {
            step(self.dt_secs)?;
        }
        Ok(start.elapsed())
    }

    fn simulated_secs(self) -> f64 {
        self.number as f64 * self.dt_secs
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn each_run_is_named_once() {
        for Problem { name, runs, .. } in problems(false) {
            let names: HashSet<String> = runs.iter().map(|run| format!("{} {:?} {:e}", run.method, run.cells, run.dt_secs)).collect();
            assert!(!runs.is_empty());
            // Runs of one pressure method differ in tolerance or number of sweeps.
            assert!(names.len() == runs.len() || name.starts_with("Projection"), "{name}");
        }
        let names: HashSet<&str> = problems(false).iter().map(|problem| problem.name).collect();
        assert_eq!(names.len(), problems(false).len());
    }

    #[test]
    fn the_coarsest_run_of_each_problem_gets_near_the_answer() {
        let largest = [0.1, 0.2, 0.1, 0.25, 0.25, 0.1, 0.01, 1e-10];
        for (Problem { name, runs, .. }, largest) in problems(true).into_iter().zip(largest) {
            let error = (runs[0].solve)().unwrap().error;
            assert!(error.l2 > 0.0 && error.l2 < largest, "{name}: {error:?}");
        }
    }

    #[test]
    fn every_figure_has_its_data() {
        for figure in FIGURES.iter().chain(&FAILURES) {
            let drawn = (figure.draw)(true, "caption").unwrap();
            assert!(drawn.svg.contains("caption") && drawn.csv.lines().count() > 5 && !drawn.summary.is_empty(), "{}", figure.name);
        }
    }
}
