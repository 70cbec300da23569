//! The tables of the documents: fitted orders and stability limits.

use anyhow::{Context as _, Result};

use prairie_wind::Boundary::{NoSlip, Wrap};

use super::table::{markdown, splice};
use crate::limits::{Limit, Transport, dust_bounds, explicit_diffusion};
use crate::orders::{self, Order, assert_expected};

/// Orders as a Markdown table.
pub fn orders_table(rows: &[Order]) -> String {
    let cells = |row: &Order| {
        let least = row.errors.last().map_or(f64::NAN, |(_, error)| *error);
        let Order { problem, scheme, quantity, formal, pinned, fitted, .. } = row;
        vec![
            (*problem).to_owned(),
            scheme.clone(),
            (*quantity).to_owned(),
            format!("{formal}"),
            format!("{fitted:.2}{}", if pinned.is_some() { " *" } else { "" }),
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
        explicit_diffusion("cubes", [8; 3], [1.0; 3], [Wrap; 2], false),
        explicit_diffusion("flat cells", [8; 3], [4.0, 1.0, 2.0], [Wrap; 2], false),
        explicit_diffusion("cubes", [8; 3], [1.0; 3], [Wrap; 2], true),
        explicit_diffusion("flat cells between walls", [8; 3], [4.0, 1.0, 2.0], [NoSlip; 2], false),
        explicit_diffusion("flat cells between walls", [8; 3], [4.0, 1.0, 2.0], [NoSlip; 2], true),
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

/// Asserts that fitted orders are the expected ones, and that the document's table has these rows.
///
/// # Panics
/// If not.
pub fn assert_published(rows: &[Order]) {
    assert_expected(rows);
    let found: Vec<_> = rows.iter().map(|row| vec![row.problem, row.scheme.as_str(), row.quantity]).collect();
    let documented: Vec<_> =
        names(include_str!("../../../tests/README.md"), "orders").into_iter().filter(|name| found.contains(name)).collect();
    assert_eq!(documented, found, "write the table anew: {WRITE}");
}

/// Command that writes the tables.
const WRITE: &str = "cargo run --release -p tests --bin chart -- tables";

/// The first cells of each row of a table, its key.
fn names<'a>(document: &'a str, table: &str) -> Vec<Vec<&'a str>> {
    let (_, rest) = document.split_once(&format!("<!-- {table} -->")).expect("the document has the table's mark");
    let (rows, _) = rest.split_once("<!-- /").expect("the table ends");
    let rows = rows.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| --"));
    rows.skip(1).map(|row| row.split('|').map(str::trim).skip(1).take(3).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limits_in_the_document_have_the_rows_that_are_written() {
        let document = include_str!("../../../tests/README.md");
        let written = splice(document, "limits", &limits_table(&all_limits())).expect("the document has the table's marks");
        // The names of the limits only; the third cell is a number.
        let schemes =
            |document: &'_ str| names(document, "limits").into_iter().map(|row| format!("{} {}", row[0], row[1])).collect::<Vec<_>>();
        assert_eq!(schemes(document), schemes(&written), "write the table anew: {WRITE}");
        assert!(schemes(document).len() > 10);
    }

    #[test]
    fn the_orders_in_the_document_are_of_the_problems_that_are_measured() {
        let names = names(include_str!("../../../tests/README.md"), "orders");
        let mut problems: Vec<_> = names.iter().map(|name| (name[0], name[2])).collect();
        problems.dedup();
        assert!(names.len() == 42 && problems.len() == 9, "a row for each scheme of nine runs: {problems:?}");
    }
}
