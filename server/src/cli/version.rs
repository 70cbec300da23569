//! The version of the program, with the commit and the features that it was built from.

use std::sync::LazyLock;

/// Version for `-V`.
pub(super) const SHORT: &str = env!("CARGO_PKG_VERSION");

/// Optional parts of the program, and whether this one has them.
const FEATURES: &[(&str, bool)] = &[
    ("acme", cfg!(feature = "acme")),
    ("picture", cfg!(feature = "picture")),
    ("rerun", cfg!(feature = "rerun")),
    ("zarr", cfg!(feature = "zarr")),
];

/// Longest name of a commit (hex digits), that of SHA-256.
const LONGEST: usize = 64;

/// The commit of the sources. A constant, so that the program contains no other part of git's log.
const COMMIT: [u8; LONGEST] = newest_commit(include_bytes!(env!("PRAIRIE_GIT_LOG")));

/// Version, commit if the sources were a git checkout, and features, for `--version`.
pub(super) static LONG: LazyLock<String> = LazyLock::new(|| {
    let features: Vec<_> = FEATURES.iter().filter(|(_, built)| *built).map(|(name, _)| *name).collect();
    let features = if features.is_empty() { "none".to_owned() } else { features.join(", ") };
    let commit = text(&COMMIT).map(|commit| format!("\ncommit: {commit}")).unwrap_or_default();
    format!("{SHORT}{commit}\nfeatures: {features}")
});

/// The newest commit in the log of a checkout's `HEAD`, the second word of the last line, with zeros behind it.
const fn newest_commit(log: &[u8]) -> [u8; LONGEST] {
    let mut line = log.len().saturating_sub(1);
    while line > 0 && log[line - 1] != b'\n' {
        line -= 1;
    }
    let mut at = line;
    while at < log.len() && log[at] != b' ' {
        at += 1;
    }
    let (start, mut commit) = (at + 1, [0; LONGEST]);
    let mut digit = 0;
    while digit < LONGEST && start + digit < log.len() && log[start + digit].is_ascii_hexdigit() {
        commit[digit] = log[start + digit];
        digit += 1;
    }
    commit
}

/// The text of a commit; `None` if there is none.
fn text(commit: &[u8; LONGEST]) -> Option<&str> {
    let digits = commit.split(|&digit| digit == 0).next()?;
    std::str::from_utf8(digits).ok().filter(|digits| digits.len() >= 7)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_commit_is_the_newest_of_the_log() {
        let [old, new] = ["0123456789012345678901234567890123456789", "abcdefabcdefabcdefabcdefabcdefabcdefabcd"];
        let commit = |log: &str| text(&newest_commit(log.as_bytes())).map(str::to_owned);
        let log = format!("{old} {old} A <a@b> 1700000000 +0000\tclone\n{old} {new} A B <a@b> 1700000001 +0000\tcommit: add {old}\n");
        assert_eq!(commit(&log), Some(new.to_owned()));
        assert_eq!(commit(&format!("- {new}\n")), Some(new.to_owned()));
        assert_eq!(commit(&format!("- {}\n", "9".repeat(64))), Some("9".repeat(64)));
        for nothing in ["", "\n", "a", "a b\n", "ref: refs/heads/main\n"] {
            assert_eq!(commit(nothing), None, "{nothing}");
        }
    }
}
