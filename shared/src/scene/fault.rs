//! Faults of a scene file, with their position in the text.

use std::fmt;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A fault of a scene file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneFault {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Number of characters on that line that the fault is about, at least 1.
    pub length: usize,
    /// Path of the field, such as `wind.cells[1]`; empty for a syntax error.
    pub path: String,
    /// The value and the allowed range; continues the sentence after the path.
    pub message: String,
}

impl fmt::Display for SceneFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.path.is_empty() {
            write!(f, "`{}` ", self.path)?;
        }
        f.write_str(&self.message)
    }
}

impl SceneFault {
    /// A fault of the field at `path` of a scene file's `text`. Points to the nearest enclosing section if the file does not contain the field, or to
    /// the start of the file.
    pub fn at(text: &str, path: &str, message: impl Into<String>) -> Self {
        let root = DeTable::parse(text).unwrap_or_else(|_| Spanned::new(0..0, DeTable::new()));
        Self::spanning(text, span_of(root.get_ref(), path), path, message)
    }

    /// A fault of the byte range `span` of `text`.
    pub(super) fn spanning(text: &str, span: Range<usize>, path: &str, message: impl Into<String>) -> Self {
        let start = floor_char(text, span.start);
        let line_start = text[..start].rfind('\n').map_or(0, |at| at + 1);
        let line_end = text[start..].find('\n').map_or(text.len(), |at| start + at);
        let end = floor_char(text, span.end).clamp(start, line_end);
        Self {
            line: text[..line_start].matches('\n').count() + 1,
            column: text[line_start..start].chars().count() + 1,
            length: text[start..end].chars().count().max(1),
            path: path.to_owned(),
            message: message.into(),
        }
    }
}

fn floor_char(text: &str, at: usize) -> usize {
    (0..=at.min(text.len())).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0)
}

/// Byte range of the value at `path`, or of the nearest section around it.
fn span_of(root: &DeTable<'_>, path: &str) -> Range<usize> {
    let mut table = root;
    let mut span = 0..0;
    for key in path.split('.') {
        let (key, index) = match key.split_once('[') {
            Some((key, index)) => (key, index.trim_end_matches(']').parse().ok()),
            None => (key, None),
        };
        let Some((_, value)) = table.iter().find(|(name, _)| name.get_ref() == key) else { break };
        let value = element(value, index);
        span = value.span();
        match value.get_ref() {
            DeValue::Table(inner) => table = inner,
            _ => break,
        }
    }
    span
}

fn element<'a, 'i>(value: &'a Spanned<DeValue<'i>>, index: Option<usize>) -> &'a Spanned<DeValue<'i>> {
    match (value.get_ref(), index) {
        (DeValue::Array(items), Some(index)) => items.get(index).unwrap_or(value),
        _ => value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "summary = \"é\"\n[wind] # é\n  cells = [1, 2, 300]\n";

    #[test]
    fn points_at_a_value_an_element_a_section_or_the_start() {
        let place = |path| {
            let fault = SceneFault::at(TEXT, path, "");
            (fault.line, fault.column, fault.length)
        };
        assert_eq!(place("summary"), (1, 11, 3));
        assert_eq!(place("wind.cells"), (3, 11, 11));
        assert_eq!(place("wind.cells[2]"), (3, 18, 3));
        assert_eq!(place("wind.sources"), (2, 1, 6));
        assert_eq!(place("grass.c0_m_per_s"), (1, 1, 1));
    }

    #[test]
    fn points_into_a_list_of_sections() {
        let text = "[[wind.primitives]]\nkind = 1\n[[wind.primitives]]\nat_m = [1, 22]\n";
        let place = |path| {
            let fault = SceneFault::at(text, path, "");
            (fault.line, fault.column, fault.length)
        };
        assert_eq!(place("wind.primitives[0].kind"), (2, 8, 1));
        assert_eq!(place("wind.primitives[1].at_m[1]"), (4, 12, 2));
        assert_eq!(place("wind.primitives[1].kind"), (3, 1, 19));
    }

    #[test]
    fn any_span_of_any_text_has_a_place() {
        for start in 0..TEXT.len() + 3 {
            for end in 0..TEXT.len() + 3 {
                let fault = SceneFault::spanning(TEXT, start..end, "", "");
                assert!(fault.line >= 1 && fault.column >= 1 && fault.length >= 1);
            }
        }
    }
}
