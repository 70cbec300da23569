//! The parts of Prairie whose methods are measured.

use super::figure::Figure;
use super::{Problem, bend, plants, wind};

/// A part of Prairie whose methods are measured.
pub struct Model {
    /// Its name on the command line and in file names.
    pub name: &'static str,
    /// What is measured, in a few words.
    pub about: &'static str,
    /// Problems of error against time; with `true` only the coarser runs, for a quick look.
    pub problems: fn(quick: bool) -> Vec<Problem>,
    /// Figures other than error against time.
    pub figures: &'static [Figure],
    /// Figures of where its methods fail.
    pub failures: &'static [Figure],
}

/// The models of single methods.
pub static MODELS: [Model; 5] = [
    Model {
        name: "wind",
        about: "advection, diffusion and pressure of the wind on flows with exact solutions",
        problems: wind::problems,
        figures: &wind::FIGURES,
        failures: &wind::FAILURES,
    },
    Model {
        name: "bend",
        about: "schemes of the bend field, cost of cars and of the interactions",
        problems: bend::problems,
        figures: &bend::FIGURES,
        failures: &bend::FAILURES,
    },
    Model {
        name: "blades",
        about: "integrators of a blade in a recorded gust",
        problems: plants::blade_problems,
        figures: &[],
        failures: &plants::FAILURES,
    },
    Model {
        name: "underbrush",
        about: "sections and posture tables of underbrush, cost of drawing it and trees",
        problems: plants::underbrush_problems,
        figures: &plants::FIGURES,
        failures: &[],
    },
    Model {
        name: "force-field",
        about: "remainder of impulses on a mesh of volumes",
        problems: plants::force_field_problems,
        figures: &[],
        failures: &[],
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn every_problem_and_figure_is_named_once_and_has_the_default_method() {
        for Model { name, problems, figures, failures, .. } in &MODELS {
            let problems = problems(true);
            let names: Vec<&str> =
                problems.iter().map(|problem| problem.name).chain(figures.iter().chain(*failures).map(|figure| figure.name)).collect();
            assert_eq!(names.iter().collect::<HashSet<_>>().len(), names.len(), "{name}");
            for problem in &problems {
                let count = problem.runs.iter().filter(|run| problem.is_default(&run.method)).count();
                assert!(
                    problem.default_method.is_none() == (count == 0) && count < problem.runs.len(),
                    "{name}, {}: {count}",
                    problem.name
                );
            }
        }
    }
}
