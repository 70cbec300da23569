//! New files and folders, and those of an earlier run that are replaced.

use super::error::OutputError;
use std::fs::{self, File, OpenOptions};
use std::path::Path;

/// A new file at `path`, in place of an existing one only if `overwrite`.
///
/// # Errors
/// When it exists, or cannot be written.
pub(super) fn new_file(path: &Path, overwrite: bool) -> Result<File, OutputError> {
    if !overwrite && path.exists() {
        return Err(OutputError::Exists { path: path.to_owned() });
    }
    let mut options = OpenOptions::new();
    options.write(true).create(true).truncate(true).create_new(!overwrite);
    options.open(path).map_err(OutputError::file(path))
}

/// A folder at `path` without files, new or empty; or with those that `is_ours` removed if `overwrite` and one of them is `mark`.
///
/// # Errors
/// When there is anything else, or it cannot be written.
pub(super) fn new_folder(
    path: &Path,
    overwrite: bool,
    kind: &'static str,
    mark: &str,
    is_ours: impl Fn(&str) -> bool,
) -> Result<(), OutputError> {
    let failed = OutputError::file(path);
    if !path.exists() {
        return fs::create_dir_all(path).map_err(failed);
    }
    if !path.is_dir() {
        return Err(OutputError::NotOurs { path: path.to_owned(), kind });
    }
    let entries: Vec<_> = fs::read_dir(path).and_then(Iterator::collect::<Result<_, _>>).map_err(&failed)?;
    if entries.is_empty() {
        return Ok(());
    }
    let has_mark = path.join(mark).is_file();
    let all_ours = entries.iter().all(|entry| entry.file_name().to_str().is_some_and(&is_ours));
    if !has_mark || !all_ours {
        return Err(OutputError::NotOurs { path: path.to_owned(), kind });
    }
    if !overwrite {
        return Err(OutputError::Exists { path: path.to_owned() });
    }
    for entry in entries {
        let path = entry.path();
        let removed = if path.is_dir() { fs::remove_dir_all(&path) } else { fs::remove_file(&path) };
        removed.map_err(OutputError::file(&path))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_an_earlier_run_wrote_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run");
        let open = |overwrite| new_folder(&path, overwrite, "store", "mark", |name| ["mark", "part"].contains(&name));
        open(false).unwrap();
        open(false).unwrap();
        fs::write(path.join("part"), "").unwrap();
        assert!(matches!(open(true), Err(OutputError::NotOurs { .. })), "without its mark");
        fs::write(path.join("mark"), "").unwrap();
        assert!(matches!(open(false), Err(OutputError::Exists { .. })));
        fs::write(path.join("thesis.tex"), "").unwrap();
        assert!(matches!(open(true), Err(OutputError::NotOurs { .. })), "something else is beside it");
        fs::remove_file(path.join("thesis.tex")).unwrap();
        open(true).unwrap();
        assert_eq!(fs::read_dir(&path).unwrap().count(), 0);

        let file = folder.path().join("stations.csv");
        drop(new_file(&file, false).unwrap());
        assert!(matches!(new_file(&file, false), Err(OutputError::Exists { .. })));
        new_file(&file, true).unwrap();
        assert!(matches!(new_folder(&file, true, "store", "mark", |_| true), Err(OutputError::NotOurs { .. })));
    }
}
