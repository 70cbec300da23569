//! The runs and figures of the bend field.
//!
//! | file | what it draws |
//! |---|---|
//! | `waves` | error against time: a standing wave, a pulse, a car with a speed that follows the bend |
//! | `cars` | cost against the number of cars that move |
//! | `failures` | where each scheme is fine, inaccurate or blows up |
//! | `overlap` | error of 001's loose overlap |
//! | `figure` | axes, lines and fields of colour as SVG |

mod cars;
mod failures;
mod figure;
mod overlap;
mod waves;

use anyhow::Result;

use super::Problem;

/// A figure of its own kind.
pub struct Figure {
    /// Its name in a file's.
    pub name: &'static str,
    /// Its headline.
    pub title: &'static str,
    /// Measures and draws it: coarsely or not, with a caption.
    pub draw: fn(quick: bool, caption: &str) -> Result<Drawn>,
}

/// What became of a figure.
pub struct Drawn {
    /// The picture.
    pub svg: String,
    /// What is in it (RFC 4180).
    pub csv: String,
    /// What it says, in a few lines.
    pub said: String,
}

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
