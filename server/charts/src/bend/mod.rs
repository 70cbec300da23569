//! The runs and figures of the bend field.
//!
//! | file | chart |
//! |---|---|
//! | `waves` | error against time: a standing wave, a pulse, a car with a speed that follows the bend |
//! | `cars` | cost against the number of moving cars |
//! | `contact` | error against cost of contact that is exact or interpolated between corners |
//! | `interactions` | the four interactions of Chen & Johan; clusters in a step, beside methods that go cluster by cluster |
//! | `failures` | where each scheme is accurate, inaccurate or blows up |
//! | `overlap` | error of the loose overlap of Chen & Johan |

mod cars;
mod contact;
mod failures;
mod interactions;
mod overlap;
mod waves;

use super::Problem;
use super::figure::Figure;

/// All figures other than error against time.
pub const FIGURES: [Figure; 4] = [
    Figure { name: "cars", title: "Cost of moving cars", draw: cars::draw },
    Figure { name: "contact", title: "Contact of a car with the grass", draw: contact::draw },
    Figure { name: "interactions", title: "The four interactions", draw: interactions::draw },
    Figure { name: "overlap", title: "Error of the loose overlap", draw: overlap::draw },
];

/// Figures of where schemes fail.
pub const FAILURES: [Figure; 1] = [Figure { name: "failures", title: "Where each scheme fails", draw: failures::draw }];

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
