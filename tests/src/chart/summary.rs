//! Which method wins where, on one screen.

use std::fmt::Write as _;

use super::Row;
use super::line::{Line, distinct, front, lines};

/// Error levels shown for a problem.
const LEVELS: usize = 4;
/// Longest line (characters) that a list is broken into.
const WIDTH: usize = 120;

/// For each problem: the fastest method at a few levels of error, by how much the next one is slower, and the Pareto front.
pub fn summary(rows: &[Row], norm: &str) -> String {
    let mut text = String::new();
    let method_width = distinct(rows, |row| &row.method).iter().map(|method| method.chars().count()).fold(8, usize::max);
    for problem in distinct(rows, |row| &row.problem) {
        let lines = lines(rows, problem, norm);
        let front = front(&lines);
        let (Some(coarsest), Some(finest)) = (front.first(), front.last()) else { continue };
        let header = format!("{:<10}{:<method_width$}  {:>12}   next", "error", "fastest", "wall time");
        writeln!(text, "{problem}\n  {header}").expect("a string takes all");
        for error in levels(finest.error, coarsest.error) {
            writeln!(text, "  {}", at_level(&lines, error, method_width)).expect("a string takes all");
        }
        writeln!(text, "{}\n", wrapped(&format!("Pareto front: {}", front_text(&front)))).expect("a string takes all");
    }
    text
}

/// The fastest and the next method at one level of error.
fn at_level(lines: &[Line], error: f64, method_width: usize) -> String {
    let mut times: Vec<(f64, &str)> = lines.iter().filter_map(|line| Some((line.seconds_at(error)?, line.method))).collect();
    times.sort_by(|a, b| a.0.total_cmp(&b.0));
    let [(seconds, method), rest @ ..] = times.as_slice() else { return format!("≤ {error:<8.0e}no method gets there") };
    let next = match rest.first() {
        Some((slower, next)) => format!("{next}, {:.1}× as long", slower / seconds),
        None => "no other gets there".into(),
    };
    format!("≤ {error:<8.0e}{method:<method_width$}  {:>12}   {next}", time_text(*seconds))
}

/// Wall time per simulated second, in three digits.
pub fn time_text(seconds: f64) -> String {
    let (value, unit) = match seconds {
        s if s < 1e-3 => (s * 1e6, "µs/s"),
        s if s < 1.0 => (s * 1e3, "ms/s"),
        s => (s, "s/s"),
    };
    let digits = (2 - value.log10().floor() as i32).clamp(0, 2) as usize;
    format!("{value:.digits$} {unit}")
}

/// Round errors (1, 2 or 5 times a power of ten) from `coarsest` down to `finest`, both ends of the scale among them, at most [`LEVELS`].
fn levels(finest: f64, coarsest: f64) -> Vec<f64> {
    let decades = (finest.log10().floor() as i32..=coarsest.log10().ceil() as i32).rev();
    // Parsed, so that each is the number nearest to what is printed.
    let round = decades.flat_map(|decade| [5, 2, 1].map(|digit| format!("{digit}e{decade}").parse::<f64>().expect("a number")));
    let round: Vec<f64> = round.filter(|level| (finest..=coarsest).contains(level)).collect();
    if round.len() <= LEVELS {
        return round;
    }
    (0..LEVELS).map(|n| round[n * (round.len() - 1) / (LEVELS - 1)]).collect()
}

/// The front in words: its methods, from the one with the coarsest run on, each with the cells along the longest axis of its runs there.
fn front_text(front: &[&Row]) -> String {
    let of_method = |method: &str| {
        let cells = front.iter().filter(|row| row.method == method).map(|row| row.cells.into_iter().max().unwrap_or(0).to_string());
        format!("{method} ({})", cells.collect::<Vec<_>>().join(", "))
    };
    let methods = distinct(front.iter().copied(), |row| &row.method);
    methods.into_iter().map(of_method).collect::<Vec<_>>().join("; ")
}

/// Words set in by two, in lines of at most [`WIDTH`] characters; all lines but the first are set in further.
fn wrapped(text: &str) -> String {
    let (mut wrapped, mut column) = (String::from(" "), 1);
    for word in text.split_whitespace() {
        let length = word.chars().count();
        if column + 1 + length > WIDTH {
            wrapped.push_str("\n     ");
            column = 5;
        }
        wrapped.push(' ');
        wrapped.push_str(word);
        column += 1 + length;
    }
    wrapped
}

#[cfg(test)]
mod tests {
    use super::super::row::made_up::row;
    use super::*;

    #[test]
    fn levels_are_round_few_and_span_the_scale() {
        assert_eq!(levels(0.9e-3, 0.11), [0.1, 0.02, 5e-3, 1e-3]);
        assert_eq!(levels(0.015, 0.06), [0.05, 0.02]);
        assert_eq!(levels(0.03, 0.04), [0.0; 0]);
    }

    #[test]
    fn long_lists_are_broken() {
        let text = wrapped(&"twelve chars ".repeat(20));
        assert!(text.lines().count() == 3 && text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
        assert!(text.lines().skip(1).all(|line| line.starts_with("      ")), "{text}");
        assert_eq!(text.split_whitespace().count(), 40);
    }

    #[test]
    fn times_have_three_digits() {
        let found = [1.234e-6, 45.67e-6, 0.9876, 12.34].map(time_text);
        assert_eq!(found, ["1.23 µs/s", "45.7 µs/s", "988 ms/s", "12.3 s/s"]);
    }

    #[test]
    fn the_winner_changes_with_the_error_asked_for() {
        let rows = [
            row("vortex", "cheap", 8, 1e-1, 1e-3),
            row("vortex", "cheap", 16, 1e-2, 1e-1),
            row("vortex", "fine", 8, 5e-2, 1e-2),
            row("vortex", "fine", 16, 1e-3, 2e-2),
        ];
        let text = summary(&rows, "l2");
        let winners: Vec<&str> =
            text.lines().filter_map(|line| line.trim().strip_prefix("≤ ")).filter_map(|line| line.split_whitespace().nth(1)).collect();
        assert_eq!(winners, ["cheap", "fine", "fine", "fine"], "{text}");
        assert!(text.contains("no other gets there"), "{text}");
        assert!(text.contains("  Pareto front: cheap (8); fine (8, 16)\n"), "{text}");
    }
}
