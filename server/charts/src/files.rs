//! Files of a model's charts.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};

use super::line::lines;
use super::memory_limit::memory_limit;
use super::plot::{Labels, svg};
use super::row::{csv, json};
use super::{Problem, Row};

/// Writes `MODEL.csv`, `MODEL.json` and `MODEL-PROBLEM.svg` for each problem that has rows into a folder, which is created if
/// needed. Charts show the root mean square error; `machine` describes the machine.
///
/// # Errors
/// When the folder or a file cannot be written.
pub fn write_all(model: &str, problems: &[Problem], rows: &[Row], machine: &str, out: &Path) -> Result<Vec<PathBuf>> {
    std::fs::create_dir_all(out).with_context(|| format!("{} cannot be made", out.display()))?;
    let mut files = vec![(format!("{model}.csv"), csv(rows)), (format!("{model}.json"), json(rows)?)];
    for problem in problems {
        let Problem { name, error, per, default_method, .. } = problem;
        let lines = lines(rows, name, "l2");
        if lines.is_empty() {
            continue;
        }
        let (title, time) = (format!("{name}: cost of accuracy"), format!("wall time per {per} (s)"));
        let limit = memory_limit(problem, rows);
        let labels = Labels { title: &title, error, time: &time, caption: machine, default_method: *default_method, limit: &limit };
        files.push((format!("{model}-{}.svg", file_name(name)), svg(&lines, labels)?));
    }
    let write = |(name, text): (String, String)| {
        let path = out.join(name);
        std::fs::write(&path, text).with_context(|| format!("{} cannot be written", path.display()))?;
        Ok(path)
    };
    files.into_iter().map(write).collect()
}

/// File name of a problem: `Taylor–Green` becomes `taylor-green`, `Projection, 32³` becomes `projection-32`.
fn file_name(problem: &str) -> String {
    let words = problem.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    words.map(str::to_lowercase).collect::<Vec<_>>().join("-")
}

#[cfg(test)]
mod tests {
    use super::super::row::made_up::row;
    use super::*;

    #[test]
    fn a_file_per_problem_and_two_of_all() {
        let folder = tempfile::tempdir().unwrap();
        let rows = [row("Taylor–Green", "a", 8, 0.1, 1.0), row("Cavity, 32³", "a", 8, 0.1, 1.0), row("no place", "a", 8, 0.0, 1.0)];
        let problem = |name| Problem { name, error: "error", per: "turn", default_method: Some("a"), cell_bytes: 8, runs: Vec::new() };
        let problems = ["Taylor–Green", "Cavity, 32³", "no place", "no rows"].map(problem);
        let files = write_all("made-up", &problems, &rows, "machine", &folder.path().join("new")).unwrap();
        let names: Vec<&str> = files.iter().filter_map(|path| path.file_name()?.to_str()).collect();
        assert_eq!(names, ["made-up.csv", "made-up.json", "made-up-taylor-green.svg", "made-up-cavity-32.svg"]);
        assert!(files.iter().all(|path| std::fs::metadata(path).unwrap().len() > 0));
    }
}
