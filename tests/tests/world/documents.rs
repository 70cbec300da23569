//! Links and pictures of the documents.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail, ensure};

use super::architecture::workspace;
use super::pictures::files;

/// Largest number of pictures on the front page.
const FRONT_PAGE_PICTURES: usize = 6;

/// Lines of a Markdown document outside of code blocks.
fn prose(document: &str) -> String {
    let mut is_code = false;
    let lines = document.lines().filter(|line| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        !is_code && !is_fence
    });
    lines.map(|line| format!("{line}\n")).collect()
}

/// Targets of the links and pictures of a Markdown document.
fn targets(document: &str) -> Vec<String> {
    prose(document).split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target.to_owned()).collect()
}

/// The anchor that GitHub gives to a heading.
fn anchor(heading: &str) -> String {
    let kept = heading.trim().to_lowercase().chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c)).collect::<String>();
    kept.replace(' ', "-")
}

/// Checks that the target of a link in a document exists, including the named heading.
fn check(document: &Path, target: &str) -> Result<()> {
    let (path, heading) = target.split_once('#').unwrap_or((target, ""));
    let file = if path.is_empty() { document.to_path_buf() } else { document.parent().context("a file")?.join(path) };
    ensure!(file.exists(), "{target} does not exist");
    if !heading.is_empty() && file.extension().is_some_and(|ending| ending == "md") {
        let text = prose(&fs::read_to_string(&file)?);
        let mut headings = text.lines().filter(|line| line.starts_with('#')).map(|line| anchor(line.trim_start_matches('#')));
        ensure!(headings.any(|found| found == heading), "{target}: there is no such heading");
    }
    Ok(())
}

fn documents() -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    files(workspace(), &["md"], &mut found)?;
    ensure!(found.len() >= 5, "only {} documents were found", found.len());
    Ok(found.into_iter().map(|(path, _)| path).collect())
}

#[test]
fn links_of_documents_lead_to_existing_files_and_headings() -> Result<()> {
    let mut broken = Vec::new();
    for document in documents()? {
        for target in targets(&fs::read_to_string(&document)?).iter().filter(|target| !target.contains("://")) {
            if let Err(error) = check(&document, target) {
                broken.push(format!("{}: {error}", document.display()));
            }
        }
    }
    if !broken.is_empty() {
        bail!("broken links:\n{}", broken.join("\n"));
    }
    Ok(())
}

#[test]
fn the_front_page_shows_few_pictures() -> Result<()> {
    let pictures = prose(&fs::read_to_string(workspace().join("README.md"))?).matches("![").count();
    ensure!(pictures <= FRONT_PAGE_PICTURES, "the front page shows {pictures} pictures, more than {FRONT_PAGE_PICTURES}");
    Ok(())
}

#[test]
fn broken_links_are_found() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let document = folder.path().join("a.md");
    fs::write(&document, "# Top\n## Two words, more\n![p](b.jpg), [x](a.md#two-words-more)\n```\n[not](a.link)\n```\n[top](#top)\n")?;
    assert_eq!(targets(&fs::read_to_string(&document)?), ["b.jpg", "a.md#two-words-more", "#top"]);
    for sound in ["a.md", "#top", "a.md#two-words-more"] {
        check(&document, sound)?;
    }
    for broken in ["b.jpg", "#three", "a.md#two-words"] {
        assert!(check(&document, broken).is_err(), "{broken}");
    }
    Ok(())
}
