//! The files of a model's charts.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};

use super::Row;
use super::line::{distinct, lines};
use super::plot::{Labels, svg};
use super::row::{csv, json};
use super::table::markdown;
use crate::norms::fitted_order;

/// Writes `MODEL.csv`, `MODEL.json`, `MODEL-orders.md` and `MODEL-PROBLEM.svg` for each problem into a folder, which is made where it is missing.
/// Charts and orders are of the root mean square error; `error` says of what and in which unit, `machine` on what it was measured.
///
/// # Errors
/// When the folder or a file cannot be written.
pub fn write_all(model: &str, rows: &[Row], error: &str, machine: &str, out: &Path) -> Result<Vec<PathBuf>> {
    std::fs::create_dir_all(out).with_context(|| format!("{} cannot be made", out.display()))?;
    let mut files =
        vec![(format!("{model}.csv"), csv(rows)), (format!("{model}.json"), json(rows)?), (format!("{model}-orders.md"), orders(rows))];
    let methods = distinct(rows, |row| &row.method);
    for problem in distinct(rows, |row| &row.problem) {
        let lines = lines(rows, problem, "l2");
        if lines.is_empty() {
            continue;
        }
        let title = format!("{problem}: what accuracy costs");
        let labels = Labels { title: &title, error, time: "wall time per simulated second (s/s)", caption: machine };
        files.push((format!("{model}-{}.svg", file_name(problem)), svg(&lines, &methods, labels)?));
    }
    let write = |(name, text): (String, String)| {
        let path = out.join(name);
        std::fs::write(&path, text).with_context(|| format!("{} cannot be written", path.display()))?;
        Ok(path)
    };
    files.into_iter().map(write).collect()
}

/// A problem's name in a file's: `Taylor–Green` becomes `taylor-green`.
fn file_name(problem: &str) -> String {
    let words = problem.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    words.map(str::to_lowercase).collect::<Vec<_>>().join("-")
}

/// A Markdown table of the order in which each method's root mean square error falls with the size of a cell along x, the time step falling as it does in the rows.
/// Methods with fewer than three rows have no order and are left out.
pub fn orders(rows: &[Row]) -> String {
    let mut cells = Vec::new();
    for problem in distinct(rows, |row| &row.problem) {
        for line in lines(rows, problem, "l2").iter().filter(|line| line.rows.len() >= 3) {
            let points: Vec<(f64, f64)> = line.rows.iter().map(|row| (1.0 / row.cells[0] as f64, row.error)).collect();
            let least = points.iter().map(|point| point.1).fold(f64::INFINITY, f64::min);
            cells.push(vec![problem.to_owned(), line.method.to_owned(), format!("{:.2}", fitted_order(&points)), format!("{least:.1e}")]);
        }
    }
    markdown(&["problem", "method", "order", "least rms error"], &cells)
}

#[cfg(test)]
mod tests {
    use super::super::row::made_up::row;
    use super::*;

    #[test]
    fn orders_are_fitted_per_method() {
        let error = |cells: usize, order: f64| 3.0 * (cells as f64).powf(-order);
        let mut rows: Vec<Row> = [8, 16, 32].map(|cells| row("p", "first", cells, error(cells, 1.0), 1.0)).to_vec();
        rows.extend([8, 16, 32].map(|cells| row("p", "second", cells, error(cells, 2.0), 1.0)));
        rows.extend([8, 16].map(|cells| row("p", "short", cells, error(cells, 2.0), 1.0)));
        let text = orders(&rows);
        let lines: Vec<Vec<&str>> = text.lines().skip(2).map(|line| line.split('|').map(str::trim).collect()).collect();
        assert_eq!(lines, [["", "p", "first", "1.00", "9.4e-2", ""], ["", "p", "second", "2.00", "2.9e-3", ""]]);
    }

    #[test]
    fn a_file_per_problem_and_one_of_each_other_kind() {
        let folder = tempfile::tempdir().unwrap();
        let rows = [row("Taylor–Green", "a", 8, 0.1, 1.0), row("Cavity, Re = 100", "a", 8, 0.1, 1.0), row("no place", "a", 8, 0.0, 1.0)];
        let files = write_all("made-up", &rows, "error", "machine", &folder.path().join("new")).unwrap();
        let names: Vec<&str> = files.iter().filter_map(|path| path.file_name()?.to_str()).collect();
        assert_eq!(names, ["made-up.csv", "made-up.json", "made-up-orders.md", "made-up-taylor-green.svg", "made-up-cavity-re-100.svg"]);
        assert!(files.iter().all(|path| std::fs::metadata(path).unwrap().len() > 0));
    }
}
