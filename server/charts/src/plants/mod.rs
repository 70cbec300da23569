//! The runs and figures of blades, underbrush and the force field.
//!
//! | file | chart |
//! |---|---|
//! | `gust` | a blade's integrators in a recorded gust: error against time |
//! | `sections` | a component under its weight, in one pass (Endo et al. 2003) and in balance: error against time |
//! | `force_field` | the remainder of an impulse: error against time |
//! | `postures` | tables of postures: error against time, and against size |
//! | `constraint` | force on a plant after a gust, with and without the velocity term |
//! | `drawn` | frame time against the number of underbrush plants |
//! | `beside` | frame time with the plants of Endo et al. 2003 |
//! | `trees` | frame time against the number of trees, as meshes and as components |
//! | `stability` | longest stable time step of a blade |

mod beside;
mod constraint;
mod drawn;
mod force_field;
mod gust;
mod postures;
mod sections;
mod stability;
mod trees;

use super::Problem;
use super::figure::Figure;

/// Figures of underbrush and trees other than error against time.
pub const FIGURES: [Figure; 5] = [
    Figure { name: "postures", title: "Cost of a posture table", draw: postures::draw },
    Figure { name: "constraint", title: "The dynamic constraint", draw: constraint::draw },
    Figure { name: "drawn", title: "Cost of drawing underbrush", draw: drawn::draw },
    Figure { name: "beside", title: "The plants of Endo et al. beside ours", draw: beside::draw },
    Figure { name: "trees", title: "Cost of drawing trees", draw: trees::draw },
];

/// Figures of where integrators of a blade fail.
pub const FAILURES: [Figure; 1] = [Figure { name: "stability", title: "Longest stable time step of a blade", draw: stability::draw }];

/// Problems of blades; `quick` leaves out the finest runs.
pub fn blade_problems(quick: bool) -> Vec<Problem> {
    vec![gust::problem(quick)]
}

/// Problems of underbrush; `quick` leaves out the finest runs.
pub fn underbrush_problems(quick: bool) -> Vec<Problem> {
    vec![sections::problem(quick), postures::problem(quick)]
}

/// Problems of the force field; `quick` leaves out the finest runs.
pub fn force_field_problems(quick: bool) -> Vec<Problem> {
    vec![force_field::problem(quick)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_finest_run_of_each_problem_converges_beyond_the_coarsest() {
        for Problem { name, runs, .. } in
            [blade_problems, underbrush_problems, force_field_problems].into_iter().flat_map(|problems| problems(true))
        {
            let last = runs.iter().rposition(|run| run.method == runs[runs.len() - 1].method).unwrap();
            let first = runs.iter().position(|run| run.method == runs[last].method).unwrap();
            let [coarse, fine] = [first, last].map(|n| (runs[n].solve)().unwrap().error.l2);
            assert!(fine > 1e-9 && fine < 0.02 && fine < 0.5 * coarse, "{name}: {coarse} and {fine}");
        }
    }

    #[test]
    fn every_figure_has_its_data() {
        for figure in FIGURES.iter().chain(&FAILURES) {
            let drawn = (figure.draw)(true, "caption").unwrap();
            assert!(drawn.svg.contains("caption") && drawn.csv.lines().count() > 3 && !drawn.summary.is_empty(), "{}", figure.name);
        }
    }
}
