//! The tables of the documents: fitted orders, and where methods fail.

use anyhow::{Context as _, Result};

use super::table::{markdown, splice};
use crate::orders::{self, Order};

/// How fine the grids are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// Those whose figures are shown.
    Shown,
    /// The coarsest that give a figure, for the names of the rows.
    Least,
}

/// Everything whose order is fitted.
pub fn all_orders(size: Size) -> Vec<Order> {
    let upto = |cells: &'static [usize]| if size == Size::Shown { cells } else { &[8, 16] };
    let on = |cells: usize| if size == Size::Shown { cells } else { 4 };
    [
        orders::advection_and_time(0.25, upto(&[24, 48, 96])),
        orders::space(upto(&[16, 32, 64])),
        orders::time(on(16)),
        orders::beltrami(0.1, upto(&[8, 12, 16, 24])),
        orders::rotating_gaussian(0.2, upto(&[32, 64, 128])),
        orders::heat_space(upto(&[16, 32, 64])),
        orders::heat_time(on(16)),
    ]
    .concat()
}

/// Orders as a Markdown table.
pub fn orders_table(rows: &[Order]) -> String {
    let cells = |row: &Order| {
        let least = row.errors.last().map_or(f64::NAN, |(_, error)| *error);
        let Order { problem, scheme, quantity, formal, fitted, .. } = row;
        vec![(*problem).to_owned(), scheme.clone(), (*quantity).to_owned(), format!("{formal}"), format!("{fitted:.2}"), format!("{least:.1e}")]
    };
    markdown(&["problem", "scheme", "refined, norm", "formal", "fitted", "least error"], &rows.iter().map(cells).collect::<Vec<_>>())
}

/// A document with its tables of orders and limits written anew.
///
/// # Errors
/// When the document lacks the marks of a table.
pub fn with_tables(document: &str, size: Size) -> Result<String> {
    let name = "orders";
    splice(document, name, &orders_table(&all_orders(size))).with_context(|| format!("no pair of marks <!-- {name} --> and <!-- /{name} -->"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The cells of each row that name it: figures differ with the size.
    fn names(document: &str) -> Vec<Vec<&str>> {
        let tables = document.split("<!-- ").filter(|part| part.starts_with("orders -->") || part.starts_with("limits -->"));
        let rows = tables.flat_map(|table| table.lines().filter(|line| line.starts_with("| ")));
        rows.map(|row| row.split('|').map(str::trim).take(4).collect()).collect()
    }

    #[test]
    fn the_tables_in_the_document_have_the_rows_that_are_written() {
        let document = include_str!("../../README.md");
        let written = with_tables(document, Size::Least).unwrap();
        assert_eq!(names(document), names(&written), "write them anew: cargo run --release -p tests --bin chart -- wind --tables tests/README.md");
        assert!(names(document).len() > 20);
    }
}
