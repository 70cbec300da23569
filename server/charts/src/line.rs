//! A line per method, with interpolation between its points.

use super::Row;

/// The runs of one method on one problem.
#[derive(Clone, Debug, PartialEq)]
pub struct Line<'a> {
    /// The method.
    pub method: &'a str,
    /// Its rows in the order of the runs, from coarse to fine.
    pub rows: Vec<&'a Row>,
}

/// Distinct values in order of first occurrence.
pub fn distinct<'a>(rows: impl IntoIterator<Item = &'a Row>, word: impl Fn(&'a Row) -> &'a str) -> Vec<&'a str> {
    let mut found = Vec::new();
    for row in rows {
        if !found.contains(&word(row)) {
            found.push(word(row));
        }
    }
    found
}

/// The lines of one problem in one norm, in the order in which the methods first occur. Rows without a positive, finite error and time cannot be drawn on
/// logarithmic axes and are left out.
pub fn lines<'a>(rows: &'a [Row], problem: &str, norm: &str) -> Vec<Line<'a>> {
    let positive = |x: f64| x > 0.0 && x.is_finite();
    let fits = |row: &&Row| row.problem == problem && row.norm == norm && positive(row.error) && positive(row.wall_secs);
    let rows: Vec<&Row> = rows.iter().filter(fits).collect();
    let line = |method| Line { method, rows: rows.iter().copied().filter(|row| row.method == method).collect() };
    distinct(rows.iter().copied(), |row| &row.method).into_iter().map(line).collect()
}

/// Family of a method: its name up to the last comma. Members differ in a parameter such as `, Courant 2`.
pub fn family(method: &str) -> &str {
    method.rsplit_once(", ").map_or(method, |(family, _)| family)
}

impl Line<'_> {
    /// Wall time (s, as in [`Row::wall_secs`]) for the method to reach `error` or less: that of its cheapest such run, or less if its line, interpolated
    /// logarithmically, crosses `error` between two runs. `None` if no run reaches it: lines are not extrapolated.
    pub fn wall_secs_at(&self, error: f64) -> Option<f64> {
        let reached = self.rows.iter().filter(|row| row.error <= error).map(|row| row.wall_secs);
        let crossed = self.rows.windows(2).filter(|pair| pair[0].error > error && error >= pair[1].error).map(|pair| {
            let [a, b] = [pair[0], pair[1]];
            let fraction = (a.error / error).ln() / (a.error / b.error).ln();
            a.wall_secs * (b.wall_secs / a.wall_secs).powf(fraction)
        });
        reached.chain(crossed).min_by(f64::total_cmp)
    }
}

/// The Pareto front: the rows that no other row beats in both error and time, by falling error.
pub fn front<'a>(lines: &[Line<'a>]) -> Vec<&'a Row> {
    let mut rows: Vec<&Row> = lines.iter().flat_map(|line| line.rows.iter().copied()).collect();
    rows.sort_by(|a, b| a.wall_secs.total_cmp(&b.wall_secs).then(a.error.total_cmp(&b.error)));
    let mut best = f64::INFINITY;
    rows.retain(|row| {
        let better = row.error < best;
        best = best.min(row.error);
        better
    });
    rows
}

#[cfg(test)]
mod tests {
    use super::super::row::made_up::row;
    use super::*;

    #[test]
    fn a_line_is_straight_in_the_logarithms() {
        let rows = [row("p", "a", 16, 1e-2, 1.0), row("p", "a", 32, 1e-4, 100.0), row("q", "a", 8, 1.0, 1.0)];
        let [line] = lines(&rows, "p", "l2").try_into().unwrap();
        let near = |found: Option<f64>, exact: f64| (found.unwrap() / exact - 1.0).abs() < 1e-12;
        assert!(near(line.wall_secs_at(1e-3), 10.0));
        assert!(near(line.wall_secs_at(1e-4), 100.0));
        assert!(near(line.wall_secs_at(0.5), 1.0), "the coarsest run is good enough");
        assert_eq!(line.wall_secs_at(0.9e-4), None);
    }

    #[test]
    fn a_line_that_turns_back_counts_its_cheapest_run() {
        let rows =
            [row("p", "a", 16, 1e-2, 1.0), row("p", "a", 32, 1e-3, 50.0), row("p", "a", 64, 1e-4, 2.0), row("p", "a", 128, 1e-1, 9.0)];
        let [line] = lines(&rows, "p", "l2").try_into().unwrap();
        assert_eq!(line.wall_secs_at(1e-3), Some(2.0));
        assert_eq!(line.rows.iter().map(|row| row.cells[0]).collect::<Vec<_>>(), [16, 32, 64, 128]);
    }

    #[test]
    fn a_family_is_what_comes_before_the_last_comma() {
        assert_eq!(["conservative, damping 0, Courant 2", "Direct"].map(family), ["conservative, damping 0", "Direct"]);
    }

    #[test]
    fn rows_without_a_place_on_the_chart_are_left_out() {
        let rows = [row("p", "a", 8, 0.0, 1.0), row("p", "b", 8, f64::NAN, 1.0), row("p", "c", 8, 1.0, 0.0), row("p", "d", 8, 1.0, 1.0)];
        let methods: Vec<&str> = lines(&rows, "p", "l2").iter().map(|line| line.method).collect();
        assert_eq!(methods, ["d"]);
    }

    #[test]
    fn the_front_holds_the_runs_that_no_other_beats() {
        let rows = [
            row("p", "a", 8, 1e-1, 1.0),
            row("p", "a", 16, 1e-2, 10.0),
            row("p", "a", 32, 1e-3, 100.0),
            row("p", "b", 8, 1e-1, 2.0),
            row("p", "b", 16, 5e-3, 5.0),
            row("p", "b", 32, 5e-3, 6.0),
        ];
        let found: Vec<(&str, f64)> = front(&lines(&rows, "p", "l2")).iter().map(|row| (row.method.as_str(), row.error)).collect();
        assert_eq!(found, [("a", 1e-1), ("b", 5e-3), ("a", 1e-3)]);
    }
}
