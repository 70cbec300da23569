//! The tables of the documents: fitted orders and stability limits.

use anyhow::{Context as _, Result};

use super::table::{markdown, splice};
use crate::limits::{Limit, Transport, dust_bounds, explicit_diffusion};
use crate::orders::{self, Order};

/// Orders as a Markdown table.
pub fn orders_table(rows: &[Order]) -> String {
    let cells = |row: &Order| {
        let least = row.errors.last().map_or(f64::NAN, |(_, error)| *error);
        let Order { problem, scheme, quantity, formal, fitted, .. } = row;
        vec![
            (*problem).to_owned(),
            scheme.clone(),
            (*quantity).to_owned(),
            format!("{formal}"),
            format!("{fitted:.2}"),
            format!("{least:.1e}"),
        ]
    };
    markdown(&["problem", "scheme", "refined, norm", "formal", "fitted", "least error"], &rows.iter().map(cells).collect::<Vec<_>>())
}

/// Stability limits of all conditionally stable methods.
pub fn all_limits() -> Vec<Limit> {
    let line = Transport { cells: [16, 1, 1], spacing_m: [1.0; 3], air_m_per_s: [1.0, 0.0, 0.0], diffusivity_m2_per_s: 0.0, damping: 0.0 };
    let cube = Transport { cells: [8; 3], spacing_m: [1.0, 0.5, 2.0], air_m_per_s: [1.0, -0.7, 0.5], ..line };
    vec![
        explicit_diffusion("cubes", [8; 3], [1.0; 3], false),
        explicit_diffusion("flat cells", [8; 3], [4.0, 1.0, 2.0], false),
        explicit_diffusion("cubes", [8; 3], [1.0; 3], true),
        line.limit("advection, line"),
        cube.limit("advection, flat cells"),
        Transport { damping: 1.0, ..line }.limit("advection, damping 1, line"),
        Transport { damping: 1.0, ..cube }.limit("advection, damping 1, flat cells"),
        Transport { air_m_per_s: [0.0; 3], diffusivity_m2_per_s: 1.0, ..cube }.limit("diffusion, flat cells"),
        Transport { diffusivity_m2_per_s: 0.1, damping: 1.0, ..cube }.limit("advection and diffusion, damping 1, flat cells"),
        dust_bounds("uniform air, cubes", [12; 3], true),
        dust_bounds("turbulent air, cubes", [12; 3], false),
    ]
}

/// Limits as a Markdown table.
pub fn limits_table(rows: &[Limit]) -> String {
    let cells = |row: &Limit| {
        let Limit { scheme, number, theory, measured } = row;
        vec![scheme.clone(), (*number).to_owned(), format!("{theory:.4}"), format!("{measured:.4}"), format!("{:.3}", row.ratio())]
    };
    markdown(&["scheme", "number", "limit in theory", "measured", "ratio"], &rows.iter().map(cells).collect::<Vec<_>>())
}

/// Measures orders and limits again and replaces their tables in a document; takes minutes.
///
/// # Errors
/// When the document lacks the marks of a table.
pub fn with_tables(document: &str) -> Result<String> {
    let tables = [("orders", orders_table(&orders::all())), ("limits", limits_table(&all_limits()))];
    tables.into_iter().try_fold(document.to_owned(), |document, (name, table)| {
        splice(&document, name, &table).with_context(|| format!("no pair of marks <!-- {name} --> and <!-- /{name} -->"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first cells of each row of a table, its key.
    fn names<'a>(document: &'a str, table: &str) -> Vec<Vec<&'a str>> {
        let (_, rest) = document.split_once(&format!("<!-- {table} -->")).unwrap();
        let (rows, _) = rest.split_once("<!-- /").unwrap();
        rows.lines().filter(|line| line.starts_with("| ")).map(|row| row.split('|').map(str::trim).skip(1).take(3).collect()).collect()
    }

    #[test]
    fn the_tables_in_the_document_have_the_rows_that_are_written() {
        let document = include_str!("../../README.md");
        let written = with_tables(document).unwrap();
        for (table, fewest) in [("orders", 20), ("limits", 10)] {
            let command = "cargo run --release -p tests --bin chart -- wind --tables tests/README.md";
            assert_eq!(names(document, table), names(&written, table), "write them anew: {command}");
            assert!(names(document, table).len() > fewest, "{table}");
        }
    }
}
