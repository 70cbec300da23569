//! Size limits of the pictures in the tree: the history keeps every version of them.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, ensure};

use super::architecture::workspace;

/// Limit of all pictures together (bytes); maps of scenes are data and not counted.
const TOTAL_BYTES: u64 = 10_000_000;
/// Limit of one picture shown in documents (bytes).
const SHOWN_BYTES: u64 = 300 << 10;

/// All files below a folder with one of these endings, with their sizes (bytes). Hidden folders, build outputs and the maps of scenes are left out; the
/// pictures of scenes count.
pub(super) fn files(dir: &Path, endings: &[&str], found: &mut Vec<(PathBuf, u64)>) -> Result<()> {
    for entry in fs::read_dir(dir).with_context(|| dir.display().to_string())? {
        let entry = entry?;
        let (path, name) = (entry.path(), entry.file_name());
        if entry.file_type()?.is_dir() {
            let is_left_out =
                name.to_string_lossy().starts_with('.') || name == "target" || name == "dist" || path.ends_with("server/scenes");
            if !is_left_out {
                files(&path, endings, found)?;
            } else if path.join("pictures").is_dir() {
                files(&path.join("pictures"), endings, found)?;
            }
        } else if endings.iter().any(|ending| path.extension().is_some_and(|found| found == *ending)) {
            found.push((path, entry.metadata()?.len()));
        }
    }
    Ok(())
}

/// Checks the pictures below a folder against the limits; returns their total size (bytes).
fn check_weight(dir: &Path) -> Result<u64> {
    let mut found = Vec::new();
    files(dir, &["png", "jpg", "jpeg", "webp", "gif", "svg"], &mut found)?;
    let total: u64 = found.iter().map(|(_, bytes)| bytes).sum();
    ensure!(total <= TOTAL_BYTES, "{} pictures weigh {total} bytes, more than {TOTAL_BYTES}", found.len());
    for (path, bytes) in found.iter().filter(|(path, _)| path.components().any(|part| part.as_os_str() == "results")) {
        ensure!(path.extension().is_none_or(|ending| ending != "png"), "{}: pictures that documents show are JPEG or WebP", path.display());
        ensure!(*bytes <= SHOWN_BYTES, "{} weighs {bytes} bytes, more than {SHOWN_BYTES}", path.display());
    }
    Ok(total)
}

#[test]
fn all_pictures_together_keep_to_their_bound() -> Result<()> {
    let bytes = check_weight(workspace())?;
    println!("pictures: {:.1} MB of {:.1}", bytes as f64 / 1e6, TOTAL_BYTES as f64 / 1e6);
    ensure!(bytes > 1 << 20, "the golden pictures were not found");
    Ok(())
}

#[test]
fn too_many_or_too_heavy_pictures_are_found() -> Result<()> {
    let dir = tempfile::tempdir()?;
    let file = |name: &str, bytes: u64| -> Result<()> {
        let path = dir.path().join(name);
        fs::create_dir_all(path.parent().context("a folder")?)?;
        Ok(fs::File::create(path)?.set_len(bytes)?)
    };
    let refused = || check_weight(dir.path()).err().map_or(String::new(), |error| error.to_string());
    file("server/scenes/map.png", 2 * TOTAL_BYTES)?;
    file("server/scenes/pictures/meadow.jpg", 1)?;
    file("target/charts/big.png", 2 * TOTAL_BYTES)?;
    file("tests/results/shown.jpg", SHOWN_BYTES)?;
    file("tests/golden/a.png", TOTAL_BYTES - SHOWN_BYTES - 1)?;
    assert_eq!(refused(), "", "maps and build outputs do not count, and the bound itself is allowed");
    file("tests/golden/b.png", 1)?;
    assert!(refused().starts_with("4 pictures weigh 10000001 bytes"), "{}", refused());
    fs::remove_file(dir.path().join("tests/golden/a.png"))?;
    file("tests/results/shown.jpg", SHOWN_BYTES + 1)?;
    assert!(refused().contains("shown.jpg weighs 307201 bytes"), "{}", refused());
    file("tests/results/shown.jpg", 1)?;
    file("tests/results/gallery/shown.png", 1)?;
    assert!(refused().contains("are JPEG or WebP"), "{}", refused());
    Ok(())
}
