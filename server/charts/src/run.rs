//! Runs of methods on problems, and their timing.

use std::time::{Duration, Instant};

use anyhow::{Result, ensure};

use super::Row;
use crate::norms::Norms;

/// A problem with a known solution, and the runs that solve it.
pub struct Problem {
    /// Its name, as in [`Row::problem`].
    pub name: &'static str,
    /// Error quantity with its unit, for an axis.
    pub error: &'static str,
    /// Unit of work of the wall time: a simulated second, or a single operation.
    pub per: &'static str,
    /// The method that scenes use by default; methods whose names continue with a comma are settings of it. `None` where scenes do without.
    pub default_method: Option<&'static str>,
    /// Memory of a cell's state (bytes), from which the limit of the machine follows; 0 where there are no cells.
    pub cell_bytes: usize,
    /// The methods, each from coarse to fine.
    pub runs: Vec<Run>,
}

impl Problem {
    /// Whether a method is the default, with any setting.
    pub fn is_default(&self, method: &str) -> bool {
        let rest = self.default_method.and_then(|default| method.strip_prefix(default));
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(", "))
    }
}

/// One method at one resolution.
pub struct Run {
    /// The method, as in [`Row::method`].
    pub method: String,
    /// Cells along x, y and z.
    pub cells: [usize; 3],
    /// Time step (s); 0 where there is none.
    pub dt_secs: f64,
    /// Solves the problem from its start; repeatable except for its duration.
    pub solve: Box<dyn Fn() -> Result<Outcome>>,
}

/// Result of a run.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// Error at the end.
    pub error: Norms,
    /// Simulated time (s); 1 for a single operation.
    pub simulated_secs: f64,
    /// Time of the steps, without setup and comparison.
    pub wall: Duration,
}

/// Number of repetitions of a run. The shortest time counts, since disturbances only lengthen it.
#[derive(Clone, Copy, Debug)]
pub struct Repeats {
    /// Minimum, 1 or more.
    pub least: u32,
    /// Maximum.
    pub most: u32,
    /// Total time after which no further repetition starts.
    pub enough: Duration,
}

impl Repeats {
    /// For published figures: 2 to 200 times, until half a second has passed.
    pub const THOROUGH: Self = Self { least: 2, most: 200, enough: Duration::from_millis(500) };
    /// For a quick look: 2 to 5 times, until a twentieth of a second has passed.
    pub const QUICK: Self = Self { least: 2, most: 5, enough: Duration::from_millis(50) };
}

/// Runs and times a method; returns a row for each norm.
///
/// # Errors
/// When the run fails, ends in an error that is not finite, or differs from one repeat to the next.
pub fn measure(model: &str, problem: &str, run: &Run, repeats: Repeats) -> Result<Vec<Row>> {
    let start = Instant::now();
    let first = (run.solve)()?;
    let Norms { l1, l2, linf } = first.error;
    ensure!(linf.is_finite() && l2.is_finite(), "the error is not finite");
    let mut wall = first.wall;
    for repeat in 1..repeats.most {
        if repeat >= repeats.least && start.elapsed() >= repeats.enough {
            break;
        }
        let next = (run.solve)()?;
        ensure!(next.error == first.error, "two repeats differ: {:?} and {:?}", first.error, next.error);
        wall = wall.min(next.wall);
    }
    let row = |(norm, error): (&str, f64)| Row {
        model: model.to_owned(),
        problem: problem.to_owned(),
        method: run.method.clone(),
        cells: run.cells,
        dt_secs: run.dt_secs,
        norm: norm.to_owned(),
        error,
        wall_secs: wall.as_secs_f64() / first.simulated_secs,
    };
    Ok([("l1", l1), ("l2", l2), ("linf", linf)].map(row).to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    fn run(solve: impl Fn() -> Result<Outcome> + 'static) -> Run {
        Run { method: "none".into(), cells: [8, 1, 8], dt_secs: 0.5, solve: Box::new(solve) }
    }

    fn outcome(linf: f64, wall_secs: f64) -> Outcome {
        let error = Norms { l1: 1.0, l2: 2.0, linf };
        Outcome { error, simulated_secs: 4.0, wall: Duration::from_secs_f64(wall_secs) }
    }

    #[test]
    fn the_least_time_per_simulated_second_counts() {
        let times = Cell::new(vec![5.0, 2.0, 3.0]);
        let made_up = run(move || {
            let mut left = times.take();
            let time = left.remove(0);
            times.set(left);
            Ok(outcome(3.0, time))
        });
        let rows = measure("wind", "made-up", &made_up, Repeats { least: 3, most: 3, enough: Duration::ZERO }).unwrap();
        let figures: Vec<(&str, f64, f64)> = rows.iter().map(|row| (row.norm.as_str(), row.error, row.wall_secs)).collect();
        assert_eq!(figures, [("l1", 1.0, 0.5), ("l2", 2.0, 0.5), ("linf", 3.0, 0.5)]);
    }

    #[test]
    fn runs_that_are_not_finite_or_not_repeatable_are_rejected() {
        assert!(measure("wind", "made-up", &run(|| Ok(outcome(f64::NAN, 1.0))), Repeats::QUICK).is_err());
        let calls = Cell::new(0.0);
        let restless = run(move || {
            calls.set(calls.get() + 1.0);
            Ok(outcome(calls.get(), 1.0))
        });
        assert!(measure("wind", "made-up", &restless, Repeats::QUICK).unwrap_err().to_string().contains("differ"));
    }
}
