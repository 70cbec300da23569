//! Finds the file that names the commit of the sources.
//!
//! In a checkout it is the log of `HEAD`. The program includes that file, so a new commit recompiles the program alone, and neither the library nor this
//! script.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use crate::Result;

/// Sets `PRAIRIE_GIT_LOG` to a file whose last line has the commit as its second word, or to an empty file if the commit is unknown. `PRAIRIE_COMMIT`
/// gives the commit of sources without their git folder.
///
/// # Errors
/// When a file in `out` cannot be written.
pub(crate) fn locate(workspace: &Path, out: &Path) -> Result<()> {
    println!("cargo::rerun-if-env-changed=PRAIRIE_COMMIT");
    let given = env::var("PRAIRIE_COMMIT").ok().filter(|commit| !commit.is_empty());
    let log = match (given, git_folder(workspace)) {
        (Some(commit), _) => write(out, &commit)?,
        (None, None) => write(out, "")?,
        (None, Some(git)) => {
            let log = git.join("logs/HEAD");
            if fs::metadata(&log).is_ok_and(|file| file.len() > 0) { log } else { write(out, &asked_of_git(workspace, &git))? }
        }
    };
    println!("cargo::rustc-env=PRAIRIE_GIT_LOG={}", log.display());
    Ok(())
}

/// The git folder of the workspace itself; a repository around it, such as one of a home folder, says nothing about these sources.
fn git_folder(workspace: &Path) -> Option<PathBuf> {
    let git = workspace.join(".git");
    if git.is_dir() {
        return Some(git);
    }
    let link = fs::read_to_string(git).ok()?;
    Some(workspace.join(link.strip_prefix("gitdir:")?.trim()))
}

/// The commit according to git, for a checkout without a log; empty if git does not know it.
fn asked_of_git(workspace: &Path, git: &Path) -> String {
    println!("cargo::rerun-if-changed={}", git.join("HEAD").display());
    let output = Command::new("git").arg("-C").arg(workspace).args(["rev-parse", "HEAD"]).output();
    let commit = output.ok().filter(|output| output.status.success()).and_then(|output| String::from_utf8(output.stdout).ok());
    commit.unwrap_or_default().trim().to_owned()
}

/// Writes a commit in the form of git's log.
fn write(out: &Path, commit: &str) -> Result<PathBuf> {
    let path = out.join("commit");
    let line = if commit.is_empty() { String::new() } else { format!("- {commit}\n") };
    // Unchanged contents keep their time, so that the program is not recompiled.
    if fs::read_to_string(&path).is_ok_and(|old| old == line) {
        return Ok(path);
    }
    fs::write(&path, line).map_err(|e| format!("{}: {e}", path.display()))?;
    Ok(path)
}
