//! The runs and figures of the bend field.
//!
//! | file | what it draws |
//! |---|---|
//! | `waves` | error against time: a standing wave, a pulse, a car with a speed that follows the bend |
//! | `cars` | cost against the number of cars that move |
//! | `failures` | where each scheme is fine, inaccurate or blows up |
//! | `overlap` | error of 001's loose overlap |

mod cars;
mod failures;
mod overlap;
mod waves;

use super::Problem;
use super::figure::Figure;

/// All figures that are not of error against time.
pub const FIGURES: [Figure; 3] = [
    Figure { name: "cars", title: "What moving cars cost", draw: cars::draw },
    Figure { name: "failures", title: "Where each scheme fails", draw: failures::draw },
    Figure { name: "overlap", title: "What the loose overlap misses", draw: overlap::draw },
];

/// Problems of error against time; `quick` leaves out the finest grids.
pub fn problems(quick: bool) -> Vec<Problem> {
    vec![waves::standing(quick), waves::pulse(quick), waves::car(quick)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_coarsest_run_of_each_problem_gets_near_the_answer() {
        for Problem { name, runs, .. } in problems(true) {
            let error = (runs[0].solve)().unwrap().error;
            assert!(error.l2 > 1e-9 && error.l2 < 0.2, "{name}: {error:?}");
        }
    }
}
