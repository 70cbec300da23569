//! The folder of results.

use anyhow::{Context as _, Result, ensure};
use prairie_charts::page::Page;
use std::fs;
use std::io::ErrorKind;
use std::path::PathBuf;

/// File of the page's data, to which later measurements are added.
const DATA: &str = "charts.json";

/// A folder of results, and the page with all of them.
pub(super) struct Folder {
    path: PathBuf,
    pub(super) page: Page,
}

impl Folder {
    /// Opens or makes the folder. Results that are in it are kept.
    ///
    /// # Errors
    /// When the folder cannot be made, or holds results of another machine, program or depth, or other data.
    pub(super) fn open(path: &std::path::Path, is_quick: bool, command: &str) -> Result<Self> {
        fs::create_dir_all(path).with_context(|| format!("{} cannot be made", path.display()))?;
        let date = time::OffsetDateTime::now_utc().date().to_string();
        let command = format!("{command}{}", if is_quick { " --quick" } else { "" });
        let new = Page::new(date, is_quick, command);
        let data = path.join(DATA);
        let mut page = match fs::read_to_string(&data) {
            Ok(text) => Page::from_json(&text).with_context(|| format!("{}: move it away, or name another folder", data.display()))?,
            Err(error) if error.kind() == ErrorKind::NotFound => new.clone(),
            Err(error) => return Err(error).with_context(|| format!("{} cannot be read", data.display())),
        };
        let depth = |is_quick| if is_quick { "quick" } else { "complete" };
        ensure!(
            page.has_origin_of(&new),
            "{} has {} results of {}; these would be {} ones of {}: name another folder with --out",
            data.display(),
            depth(page.is_quick),
            page.about,
            depth(is_quick),
            new.about
        );
        page.date = new.date;
        if !page.command.contains(&new.command) {
            page.command = format!("{} and {}", page.command, new.command);
        }
        Ok(Self { path: path.to_owned(), page })
    }

    /// Writes a file.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(super) fn write(&self, name: &str, text: &str) -> Result<()> {
        let path = self.path.join(name);
        fs::write(&path, text).with_context(|| format!("{} cannot be written", path.display()))
    }

    /// Writes the page and its data.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub(super) fn write_page(&self) -> Result<()> {
        self.write(DATA, &self.page.json())?;
        self.write("charts.html", &self.page.html())
    }

    pub(super) fn path(&self) -> &std::path::Path {
        &self.path
    }
}
