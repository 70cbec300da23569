//! Puts the page of charts together.

use std::fs;
use std::path::Path;

use crate::Result;
use crate::inline::Sources;

const SCRIPTS: [&str; 6] = ["charts-data.js", "charts-draw.js", "charts-cards.js", "charts-precision.js", "charts-maps.js", "charts.js"];

/// Writes `charts.html` with the data that are kept with the program to `page`. Writes nothing in a package outside its workspace, which lacks them.
///
/// # Errors
/// When a file cannot be read or written.
pub(crate) fn write(charts: &Path, page: &Path) -> Result<()> {
    if !charts.is_dir() {
        return Ok(());
    }
    println!("cargo::rerun-if-changed={}", charts.join("page").display());
    println!("cargo::rerun-if-changed={}", charts.join("results").display());
    let read = |name: &str| fs::read_to_string(charts.join(name)).map_err(|e| format!("{}: {e}", charts.join(name).display()));
    let source = |name: &str| read(&format!("page/{name}"));
    let (html, style, data) = (source("charts.html")?, source("charts.css")?, read("results/charts.json")?);
    let scripts = SCRIPTS.into_iter().map(source).collect::<Result<Vec<_>>>()?;
    let scripts: Vec<&str> = scripts.iter().map(String::as_str).collect();
    let complete = Sources { page: &html, style: &style, scripts: &scripts }.with_data(&data);
    fs::write(page.join("charts.html"), complete).map_err(|e| format!("{}: {e}", page.display()))
}
