//! Markdown tables, and their insertion into a document.

use std::fmt::Write as _;

/// A Markdown table with padded columns. Columns of numbers are aligned right, others left.
///
/// # Panics
/// When a row has more or fewer cells than the header.
pub fn markdown(header: &[&str], rows: &[Vec<String>]) -> String {
    assert!(rows.iter().all(|row| row.len() == header.len()), "each row has a cell per column");
    let header: Vec<String> = header.iter().map(|&word| escaped(word)).collect();
    let rows: Vec<Vec<String>> = rows.iter().map(|row| row.iter().map(|cell| escaped(cell)).collect()).collect();
    let column = |c: usize| rows.iter().map(move |row| row[c].as_str());
    let width = |c: usize| column(c).chain([header[c].as_str()]).map(|cell| cell.chars().count()).fold(3, usize::max);
    let columns: Vec<(usize, bool)> = (0..header.len()).map(|c| (width(c), !rows.is_empty() && column(c).all(is_number))).collect();

    let line = |cells: &[String]| {
        let padded = cells
            .iter()
            .zip(&columns)
            .map(|(cell, &(width, right))| if right { format!("{cell:>width$}") } else { format!("{cell:<width$}") });
        format!("| {} |\n", padded.collect::<Vec<_>>().join(" | "))
    };
    let mut text = line(&header);
    for &(width, right) in &columns {
        let dashes = "-".repeat(width);
        write!(text, "|{}", if right { format!(" {}: ", &dashes[1..]) } else { format!(" {dashes} ") }).expect("a string takes all");
    }
    text.push_str("|\n");
    rows.iter().for_each(|row| text.push_str(&line(row)));
    text
}

fn escaped(cell: &str) -> String {
    cell.replace('|', "\\|").replace('\n', " ")
}

fn is_number(cell: &str) -> bool {
    cell.starts_with(|c: char| c.is_ascii_digit() || "+-−–<>".contains(c))
}

/// Replaces the text between `<!-- NAME -->` and `<!-- /NAME -->` in a document; `None` without exactly one such pair.
pub fn splice(document: &str, name: &str, text: &str) -> Option<String> {
    let (opening, closing) = (format!("<!-- {name} -->\n"), format!("<!-- /{name} -->"));
    let (before, rest) = document.split_once(&opening)?;
    let (_, after) = rest.split_once(&closing)?;
    let unique = !after.contains(&opening) && !after.contains(&closing);
    unique.then(|| format!("{before}{opening}{text}{closing}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made_up() -> String {
        let rows = [["semi-Lagrangian", "1.02"], ["odd | name", "−10.5"]].map(|row| row.map(String::from).to_vec());
        markdown(&["method", "order"], &rows)
    }

    #[test]
    fn columns_are_aligned_and_pipes_escaped() {
        let expected =
            "| method          | order |\n| --------------- | ----: |\n| semi-Lagrangian |  1.02 |\n| odd \\| name     | −10.5 |\n";
        assert_eq!(made_up(), expected);
    }

    #[test]
    fn a_table_is_put_between_its_marks_and_again() {
        let document = "# Title\n<!-- orders -->\nold\n<!-- /orders -->\nafter\n";
        let once = splice(document, "orders", &made_up()).unwrap();
        assert!(once.starts_with("# Title\n<!-- orders -->\n| method") && once.ends_with("|\n<!-- /orders -->\nafter\n"), "{once}");
        assert_eq!(splice(&once, "orders", &made_up()), Some(once));
        assert_eq!(splice(document, "limits", ""), None);
        assert_eq!(splice(&document.repeat(2), "orders", ""), None);
    }
}
