//! The limit that memory sets to a method's time.

use super::line::lines;
use super::machine::copy_secs;
use super::{Problem, Row};

/// Name of the limit in legends.
pub(crate) const MEMORY_LIMIT: &str = "memory: state copied once a step, one core";

/// A measured time has no more digits; text with so few is read back as the same number.
fn four_digits(secs: f64) -> f64 {
    format!("{secs:.3e}").parse().expect("a number")
}

/// For each run of the default method its error, and the time (s) in which one core copies the state of all cells once in each step. Empty without cells
/// or without a default method.
pub(crate) fn memory_limit(problem: &Problem, rows: &[Row]) -> Vec<[f64; 2]> {
    if problem.cell_bytes == 0 {
        return Vec::new();
    }
    let lines = lines(rows, problem.name, "l2");
    let Some(line) = lines.iter().find(|line| problem.is_default(line.method)) else { return Vec::new() };
    let time = |row: &Row| {
        let steps = if row.dt_secs > 0.0 { 1.0 / row.dt_secs } else { 1.0 };
        four_digits(steps * copy_secs(row.cells.iter().product::<usize>() * problem.cell_bytes))
    };
    line.rows.iter().map(|row| [row.error, time(row)]).collect()
}
