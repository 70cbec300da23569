//! Faults of a scene file, with their position in the text.

use super::Positions;
use crate::escape::escape_invisible;
use std::fmt;

/// A fault of a scene file. Displayed without invisible characters, which names and values may contain.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneFault {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Length of the marked part of that line (characters), at least 1.
    pub length: usize,
    /// Path of the field, such as `wind.cells[1]`; empty for a syntax error.
    pub path: String,
    /// The value and the allowed range; continues the sentence after the path.
    pub message: String,
}

impl fmt::Display for SceneFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.path.is_empty() {
            write!(f, "`{}` ", escape_invisible(&self.path))?;
        }
        f.write_str(&escape_invisible(&self.message))
    }
}

impl SceneFault {
    /// A fault of the field at `path` of a scene file's `text`, as [`Positions::at`]; for several faults of one text, that is quicker.
    pub fn at(text: &str, path: &str, message: impl Into<String>) -> Self {
        Positions::new(text).at(path, message)
    }
}
