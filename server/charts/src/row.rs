//! A measured figure, and its CSV and JSON.

use std::fmt::Write as _;

use serde::Serialize;

/// One norm of the error of a run, and its cost.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Model, such as `wind`.
    pub model: String,
    /// The problem, such as `Taylor–Green`.
    pub problem: String,
    /// The method, such as `MacCormack`.
    pub method: String,
    /// Cells along x, y and z.
    pub cells: [usize; 3],
    /// Time step (s); 0 where there is none.
    pub dt_secs: f64,
    /// Norm of the error: `l1`, `l2` (root mean square) or `linf`.
    pub norm: String,
    /// The error, in the unit of the solution.
    pub error: f64,
    /// Wall time (s) per simulated second, or of a single operation; the shortest of repeated runs.
    pub wall_secs: f64,
}

/// Cells in words: `64×1×64`.
pub fn cells_text([x, y, z]: [usize; 3]) -> String {
    format!("{x}×{y}×{z}")
}

/// Rows as CSV (RFC 4180) with a header line; cells as `64x1x64`. Numbers are exact when read back.
pub fn csv(rows: &[Row]) -> String {
    let mut text = String::from("model,problem,method,cells,dt_secs,norm,error,wall_secs\n");
    for row in rows {
        let [x, y, z] = row.cells;
        let [model, problem, method, norm] = [&row.model, &row.problem, &row.method, &row.norm].map(|word| quoted(word));
        let Row { dt_secs, error, wall_secs, .. } = row;
        writeln!(text, "{model},{problem},{method},{x}x{y}x{z},{dt_secs:e},{norm},{error:e},{wall_secs:e}").expect("a string takes all");
    }
    text
}

fn quoted(word: &str) -> String {
    if word.contains([',', '"', '\n', '\r']) { format!("\"{}\"", word.replace('"', "\"\"")) } else { word.to_owned() }
}

/// Rows as a JSON array, a row per line; cells as an array of three.
///
/// # Errors
/// Never for finite or non-finite numbers: the latter become `null`.
pub fn json(rows: &[Row]) -> serde_json::Result<String> {
    let lines: Vec<String> = rows.iter().map(serde_json::to_string).collect::<Result<_, _>>()?;
    Ok(format!("[\n{}\n]\n", lines.join(",\n")))
}

#[cfg(test)]
pub(super) mod made_up {
    use super::Row;

    /// A row with invented figures.
    pub(crate) fn row(problem: &str, method: &str, cells: usize, error: f64, wall_secs: f64) -> Row {
        Row {
            model: "made-up".into(),
            problem: problem.into(),
            method: method.into(),
            cells: [cells, 1, cells],
            dt_secs: 1.0 / cells as f64,
            norm: "l2".into(),
            error,
            wall_secs,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn csv_quotes_what_would_break_it() {
        let rows = [made_up::row("a \"bad\", name", "plain", 8, 0.1, 2.5e-7)];
        let text = csv(&rows);
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some("model,problem,method,cells,dt_secs,norm,error,wall_secs"));
        assert_eq!(lines.next(), Some("made-up,\"a \"\"bad\"\", name\",plain,8x1x8,1.25e-1,l2,1e-1,2.5e-7"));
        assert_eq!(lines.next(), None);
    }

    #[test]
    fn json_reads_back() {
        let rows = [made_up::row("p", "a", 8, 0.1, 1.0 / 3.0), made_up::row("p", "b", 16, 0.01, 2.0)];
        let back: serde_json::Value = serde_json::from_str(&json(&rows).unwrap()).unwrap();
        assert_eq!(back.as_array().map(Vec::len), Some(2));
        assert_eq!(back[0]["wall_secs"].as_f64(), Some(1.0 / 3.0));
        assert_eq!(back[1]["cells"], serde_json::json!([16, 1, 16]));
        assert_eq!(back[1].as_object().map(serde_json::Map::len), Some(8));
    }
}
