//! The page as Markdown. Rows that are not measured anew are kept from the page before.

use super::{Figure, Measured};
use anyhow::{Context as _, Result};
use std::fs;
use std::path::Path;

/// The figures of the page, by their quantity.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Page {
    rows: Vec<(String, Measured)>,
}

const HEAD: &str = "\
# Figures

Speeds, memory and data rates. Each row has the command that measured it, the machine and the date. Times depend on the machine and on what else it does; compare ratios. The page is written by
`cargo run --release -p tests --bin figures` (about half an hour on an idle machine); `--only TEXT` measures some rows again and keeps the others, `--list` names them.

More figures: [orders and limits](../README.md#orders-and-limits-of-the-wind), [the bend field](../README.md#the-bend-field), [charts of error against time](../README.md#charts),
[frame times and similarity of ten views](gallery/README.md).

";
const COLUMNS: &str = "| quantity | figure | aim | command | measured |\n|---|---|---|---|---|\n";

impl Page {
    /// Reads a page that [`text`](Self::text) has written; empty if the file does not exist.
    ///
    /// # Errors
    /// When the file cannot be read, or a row has other columns.
    pub fn read(path: &Path) -> Result<Self> {
        if !path.exists() {
            return Ok(Self::default());
        }
        let text = fs::read_to_string(path).with_context(|| path.display().to_string())?;
        let is_row = |line: &&str| line.starts_with("| ") && !line.starts_with("| quantity |");
        let rows = text.lines().filter(is_row).map(|line| {
            let cells: Vec<&str> = line.trim_matches('|').split(" | ").map(str::trim).collect();
            let [quantity, figure, _aim, _command, measured] =
                cells.as_slice().try_into().with_context(|| format!("{}: five columns are expected in `{line}`", path.display()))?;
            Ok((str::to_owned(quantity), Measured { figure: str::to_owned(figure), when_and_where: str::to_owned(measured) }))
        });
        Ok(Self { rows: rows.collect::<Result<_>>()? })
    }

    /// Adds or replaces a figure.
    pub fn set(&mut self, figure: &Figure, measured: Measured) {
        self.rows.retain(|(quantity, _)| quantity != figure.quantity);
        self.rows.push((figure.quantity.to_owned(), measured));
    }

    /// The page, with a row for each of `figures` in their order; those never measured say so.
    pub fn text(&self, figures: &[Figure]) -> String {
        let row = |figure: &Figure| {
            let stored = self.rows.iter().find(|(quantity, _)| quantity == figure.quantity);
            let (found, measured) = stored.map_or(("not measured yet", ""), |(_, measured)| (&measured.figure, &measured.when_and_where));
            format!("| {} | {found} | {} | `{}` | {measured} |\n", figure.quantity, figure.aim, figure.command)
        };
        format!("{HEAD}{COLUMNS}{}", figures.iter().map(row).collect::<String>())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{FIGURES, Pick};
    use super::*;

    const SPEED: Figure = Figure { quantity: "speed", aim: "1 ms", command: "go fast", pick: Pick::After("x") };
    const SIZE: Figure = Figure { quantity: "size", aim: "", command: "go", pick: Pick::After("y") };

    fn measured(figure: &str) -> Measured {
        Measured { figure: figure.to_owned(), when_and_where: "2026-11-24, here".to_owned() }
    }

    #[test]
    fn rows_survive_writing_and_reading() -> Result<()> {
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("figures.md");
        assert_eq!(Page::read(&path)?, Page::default());
        let mut page = Page::default();
        page.set(&SPEED, measured("2 ms"));
        page.set(&SIZE, measured("3 MB"));
        page.set(&SPEED, measured("0.9 ms"));
        fs::write(&path, page.text(&[SPEED, SIZE]))?;
        assert!(
            page.text(&[SPEED, SIZE])
                .ends_with("| speed | 0.9 ms | 1 ms | `go fast` | 2026-11-24, here |\n| size | 3 MB |  | `go` | 2026-11-24, here |\n")
        );
        assert_eq!(Page::read(&path)?.text(&[SPEED, SIZE]), page.text(&[SPEED, SIZE]));
        Ok(())
    }

    #[test]
    fn the_stored_page_has_every_figure_with_its_command() -> Result<()> {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/figures.md");
        let stored = fs::read_to_string(&path)?;
        let expected = Page::read(&path)?.text(FIGURES);
        assert!(
            stored == expected,
            "tests/results/figures.md is old; `cargo run --release -p tests --bin figures -- --only nothing` writes:\n{expected}"
        );
        assert!(!stored.contains("not measured yet"), "figures are missing");
        Ok(())
    }
}
