//! Names of files for messages.

use prairie_core::escape::escape_invisible;
use std::ffi::OsStr;
use std::fmt::Write as _;

/// The name of a file with invisible characters, such as the escape sequences of a terminal, and bytes that are not UTF-8 replaced by escapes.
pub fn escaped(name: impl AsRef<OsStr>) -> String {
    let mut shown = String::new();
    for chunk in name.as_ref().as_encoded_bytes().utf8_chunks() {
        shown.push_str(&escape_invisible(chunk.valid()));
        for byte in chunk.invalid() {
            let _ = write!(shown, "\\x{byte:02x}");
        }
    }
    shown
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::ffi::OsStrExt as _;

    #[test]
    fn other_bytes_and_escape_sequences_are_shown_by_their_code() {
        assert_eq!(escaped("scenes/hügel 1.toml"), "scenes/hügel 1.toml");
        assert_eq!(escaped(OsStr::from_bytes(b"a\xff\x1b[2J\xc3\xbc\xc3.toml")), "a\\xff\\u{1b}[2Jü\\xc3.toml");
    }
}
