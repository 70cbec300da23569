//! The fastest method per problem and error, as text.

use std::fmt::Write as _;

use super::line::{Line, family, lines};
use super::{Problem, Row};

/// Error levels shown for a problem.
const LEVELS: usize = 3;

/// Lists, for each problem and a few error levels, the fastest method, its wall time, and how much longer the best of another family takes.
pub fn summary(problems: &[Problem], rows: &[Row], norm: &str) -> String {
    let name_width = problems.iter().map(|problem| problem.name.chars().count()).fold(8, usize::max);
    let method_width = rows.iter().map(|row| row.method.chars().count()).fold(8, usize::max);
    let mut text = format!("{:<name_width$}  {:<7}  {:<method_width$}  {:>9}  next best\n", "problem", "error ≤", "fastest", "wall time");
    for problem in problems {
        let lines = lines(rows, problem.name, norm);
        let errors = || lines.iter().flat_map(|line| &line.rows).map(|row| row.error);
        let levels = levels(errors().fold(f64::INFINITY, f64::min), errors().fold(0.0, f64::max));
        for (error, name) in levels.into_iter().zip([problem.name].into_iter().chain(std::iter::repeat(""))) {
            let Some(Winner { method, wall_secs, next }) = winner(&lines, error) else { continue };
            let next = match next {
                Some((next, slower)) => format!("{next}: {slower:.1}×"),
                None => "no other reaches it".into(),
            };
            let (error, time) = (format!("{error:.0e}"), time_text(wall_secs));
            writeln!(text, "{name:<name_width$}  {error:<7}  {method:<method_width$}  {time:>9}  {next}")
                .expect("writing to a string cannot fail");
        }
    }
    text
}

/// The fastest method at an error level, and the next of another family.
struct Winner<'a> {
    method: &'a str,
    wall_secs: f64,
    /// Its name, and its time over that of the fastest.
    next: Option<(&'a str, f64)>,
}

fn winner<'a>(lines: &[Line<'a>], error: f64) -> Option<Winner<'a>> {
    let mut times: Vec<(f64, &str)> = lines.iter().filter_map(|line| Some((line.wall_secs_at(error)?, line.method))).collect();
    times.sort_by(|a, b| a.0.total_cmp(&b.0));
    let &(wall_secs, method) = times.first()?;
    let next = times.iter().find(|(_, next)| family(next) != family(method)).map(|&(slower, next)| (next, slower / wall_secs));
    Some(Winner { method, wall_secs, next })
}

/// Wall time with three significant digits.
pub fn time_text(wall_secs: f64) -> String {
    let (value, unit) = match wall_secs {
        s if s < 1e-3 => (s * 1e6, "µs"),
        s if s < 1.0 => (s * 1e3, "ms"),
        s => (s, "s"),
    };
    let digits = (2 - value.log10().floor() as i32).clamp(0, 2) as usize;
    format!("{value:.digits$} {unit}")
}

/// Round errors (1, 2 or 5 times a power of ten) from `coarsest` down to `finest`, including both ends of the scale, at most [`LEVELS`].
fn levels(finest: f64, coarsest: f64) -> Vec<f64> {
    if finest > coarsest {
        return Vec::new();
    }
    let decades = (finest.log10().floor() as i32..=coarsest.log10().ceil() as i32).rev();
    // Parsed, so that each number is the one nearest to its printed form.
    let round = decades.flat_map(|decade| [5, 2, 1].map(|digit| format!("{digit}e{decade}").parse::<f64>().expect("a number")));
    let round: Vec<f64> = round.filter(|level| (finest..=coarsest).contains(level)).collect();
    if round.len() <= LEVELS {
        return round;
    }
    (0..LEVELS).map(|n| round[n * (round.len() - 1) / (LEVELS - 1)]).collect()
}

#[cfg(test)]
mod tests {
    use super::super::row::made_up::row;
    use super::*;

    #[test]
    fn levels_are_round_few_and_span_the_scale() {
        assert_eq!(levels(0.9e-3, 0.11), [0.1, 0.01, 1e-3]);
        assert_eq!(levels(0.015, 0.06), [0.05, 0.02]);
        assert_eq!(levels(0.03, 0.04), [0.0; 0]);
        assert_eq!(levels(f64::INFINITY, 0.0), [0.0; 0]);
    }

    #[test]
    fn times_have_three_digits() {
        let found = [1.234e-6, 45.67e-6, 0.9876, 12.34].map(time_text);
        assert_eq!(found, ["1.23 µs", "45.7 µs", "988 ms", "12.3 s"]);
    }

    #[test]
    fn the_fastest_method_depends_on_the_error() {
        let rows = [
            row("vortex", "cheap, Courant 1", 8, 1e-1, 1e-3),
            row("vortex", "cheap, Courant 1", 16, 1e-2, 1e-1),
            row("vortex", "cheap, Courant 2", 8, 1e-1, 2e-3),
            row("vortex", "fine", 8, 5e-2, 1e-2),
            row("vortex", "fine", 16, 1e-3, 2e-2),
        ];
        let problem = |name| Problem { name, error: "error", per: "turn", default_method: None, cell_bytes: 0, runs: Vec::new() };
        let text = summary(&[problem("vortex"), problem("not run")], &rows, "l2");
        let words: Vec<Vec<&str>> =
            text.lines().skip(1).map(|line| line.split("  ").map(str::trim).filter(|word| !word.is_empty()).collect()).collect();
        assert_eq!(
            words,
            [
                vec!["vortex", "1e-1", "cheap, Courant 1", "1.00 ms", "fine: 10.0×"],
                vec!["1e-2", "fine", "13.3 ms", "cheap, Courant 1: 7.5×"],
                vec!["1e-3", "fine", "20.0 ms", "no other reaches it"],
            ],
            "{text}"
        );
    }
}
