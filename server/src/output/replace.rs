//! New files and folders, and those of an earlier run that are replaced.

use super::error::OutputError;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Read as _};
use std::path::Path;

/// A new file at `path`, or an empty one; or in place of one that begins with `mark`, as those of an earlier run do, if `overwrite`.
///
/// # Errors
/// When there is anything else, or it cannot be written.
pub(super) fn new_file(path: &Path, overwrite: bool, kind: &'static str, mark: &str) -> Result<File, OutputError> {
    if path.exists() {
        if !path.is_file() || !begins_with(path, mark).map_err(OutputError::file(path))? {
            return Err(OutputError::NotOurs { path: path.to_owned(), kind });
        }
        if !overwrite {
            return Err(OutputError::Exists { path: path.to_owned() });
        }
    }
    let mut options = OpenOptions::new();
    options.write(true).create(true).truncate(true).create_new(!overwrite);
    options.open(path).map_err(OutputError::file(path))
}

/// Whether a file is empty or begins with `mark`.
fn begins_with(path: &Path, mark: &str) -> io::Result<bool> {
    let mut beginning = Vec::new();
    File::open(path)?.take(mark.len() as u64).read_to_end(&mut beginning)?;
    Ok(beginning.is_empty() || beginning == mark.as_bytes())
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
        let open = |overwrite| new_file(&file, overwrite, "file of stations", "time_s,");
        drop(open(false).unwrap());
        fs::write(&file, "time_s,station\n").unwrap();
        assert!(matches!(open(false), Err(OutputError::Exists { .. })));
        drop(open(true).unwrap());
        assert_eq!(fs::read_to_string(&file).unwrap(), "");
        fs::write(&file, "time_t").unwrap();
        assert!(matches!(open(true), Err(OutputError::NotOurs { .. })), "it begins otherwise");
        assert_eq!(fs::read_to_string(&file).unwrap(), "time_t");
        assert!(matches!(new_folder(&file, true, "store", "mark", |_| true), Err(OutputError::NotOurs { .. })));
    }
}
