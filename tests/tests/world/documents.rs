//! Links and pictures of the documents.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail, ensure};

use prairie_client::render::Quality;
use prairie_core::scene::VehicleKind;

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

/// Documents that describe the present product.
const READMES: [&str; 5] = ["README.md", "server/README.md", "client-wasm/README.md", "shared/README.md", "shared/vehicles/README.md"];

/// Sentences and table cells of a document that name at least three of some words, in any case or with a plural s, and those that each leaves out.
fn lists<'a>(document: &str, words: &[&'a str]) -> Vec<(String, Vec<&'a str>)> {
    let prose = prose(document);
    let sentences = prose.lines().flat_map(|line| line.split(['|', ';']).flat_map(|part| part.split(". ")));
    let named = |sentence: &str, word: &str| {
        let mut found = sentence.split(|c: char| !c.is_alphanumeric());
        found.any(|one| one.eq_ignore_ascii_case(word) || one.strip_suffix('s').is_some_and(|one| one.eq_ignore_ascii_case(word)))
    };
    let lists = sentences.map(|sentence| (sentence, words.iter().copied().filter(|word| !named(sentence, word)).collect::<Vec<_>>()));
    lists.filter(|(_, missing)| missing.len() + 3 <= words.len()).map(|(sentence, missing)| (sentence.trim().to_owned(), missing)).collect()
}

#[test]
fn lists_of_vehicles_and_presets_are_complete() -> Result<()> {
    let mut incomplete = Vec::new();
    for words in [VehicleKind::ALL.map(VehicleKind::name).to_vec(), Quality::ALL.map(Quality::name).to_vec()] {
        let mut count = 0;
        for document in READMES {
            let lists = lists(&fs::read_to_string(workspace().join(document))?, &words);
            count += lists.len();
            let short = lists.into_iter().filter(|(_, missing)| !missing.is_empty());
            incomplete.extend(short.map(|(sentence, missing)| format!("{document}: {} missing in: {sentence}", missing.join(", "))));
        }
        ensure!(count > 0, "no list of {} was found", words.join(", "));
    }
    ensure!(incomplete.is_empty(), "{}", incomplete.join("\n"));
    Ok(())
}

#[test]
fn an_incomplete_list_is_found() {
    let document = "Cars, sleds and a Ball. A car hits a sled.\n| low, `high` | monsters, cars, balls; helicopter, sled |\n";
    let words = ["car", "monster", "sled", "ball"];
    let found = lists(document, &words);
    let found: Vec<_> = found.iter().map(|(sentence, missing)| (sentence.as_str(), missing.as_slice())).collect();
    assert_eq!(found, [("Cars, sleds and a Ball", &["monster"][..]), ("monsters, cars, balls", &["sled"][..])]);
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
