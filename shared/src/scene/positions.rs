//! Positions of faults in the text of a file, each found in constant time.

use super::SceneFault;
use std::cell::OnceCell;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Bytes between two counts of the characters before them.
const STRIDE: usize = 256;

/// Longest path and longest message of a fault (characters); the rest is cut, since a file may contain names and texts of any length.
const LONGEST_PATH: usize = 200;
const LONGEST_MESSAGE: usize = 1000;

/// Index of a text, for the lines and columns of faults in it.
pub struct Positions<'t> {
    text: &'t str,
    /// The first byte of each line.
    lines: Vec<usize>,
    /// Number of characters before each multiple of [`STRIDE`] bytes.
    characters: Vec<usize>,
    /// The fields, parsed once they are asked for.
    root: OnceCell<Spanned<DeTable<'t>>>,
}

impl<'t> Positions<'t> {
    /// Reads the text once.
    pub fn new(text: &'t str) -> Self {
        let line_ends = text.bytes().enumerate().filter(|&(_, byte)| byte == b'\n').map(|(at, _)| at + 1);
        let mut before = 0;
        let counted = text.as_bytes().chunks(STRIDE).map(|chunk| {
            let here = before;
            before += starts_in(chunk);
            here
        });
        Self { text, lines: std::iter::once(0).chain(line_ends).collect(), characters: counted.collect(), root: OnceCell::new() }
    }

    /// A fault of the field at `path`. Points to the nearest enclosing section if the file does not contain the field, or to the start of the file.
    pub fn at(&self, path: &str, message: impl Into<String>) -> SceneFault {
        let parsed = || DeTable::parse(self.text).unwrap_or_else(|_| Spanned::new(0..0, DeTable::new()));
        self.spanning(span_of(self.root.get_or_init(parsed).get_ref(), path), path, message)
    }

    /// A fault of the byte range `span`.
    pub fn spanning(&self, span: Range<usize>, path: &str, message: impl Into<String>) -> SceneFault {
        let start = floor_char(self.text, span.start);
        let line = self.lines.partition_point(|&first| first <= start);
        let line_start = self.lines[line - 1];
        let line_end = self.lines.get(line).map_or(self.text.len(), |next| next - 1);
        let end = floor_char(self.text, span.end).clamp(start, line_end);
        SceneFault {
            line,
            column: self.characters_before(start) - self.characters_before(line_start) + 1,
            length: (self.characters_before(end) - self.characters_before(start)).max(1),
            path: cut(path.to_owned(), LONGEST_PATH),
            message: cut(message.into(), LONGEST_MESSAGE),
        }
    }

    fn characters_before(&self, byte: usize) -> usize {
        let Some(counted) = self.characters.get(byte / STRIDE) else { return self.characters_at_end() };
        counted + starts_in(&self.text.as_bytes()[byte / STRIDE * STRIDE..byte])
    }

    fn characters_at_end(&self) -> usize {
        self.characters.last().map_or(0, |counted| counted + starts_in(&self.text.as_bytes()[(self.characters.len() - 1) * STRIDE..]))
    }
}

/// Number of characters that start in a piece of UTF-8.
fn starts_in(bytes: &[u8]) -> usize {
    bytes.iter().filter(|&&byte| byte & 0xc0 != 0x80).count()
}

fn floor_char(text: &str, at: usize) -> usize {
    (0..=at.min(text.len())).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0)
}

/// The text, cut after `longest` characters.
fn cut(mut text: String, longest: usize) -> String {
    if let Some((end, _)) = text.char_indices().nth(longest) {
        text.truncate(end);
        text.push('…');
    }
    text
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
        let Some((_, value)) = table.get_key_value(key) else { break };
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
            let fault = Positions::new(TEXT).at(path, "");
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
            let fault = Positions::new(text).at(path, "");
            (fault.line, fault.column, fault.length)
        };
        assert_eq!(place("wind.primitives[0].kind"), (2, 8, 1));
        assert_eq!(place("wind.primitives[1].at_m[1]"), (4, 12, 2));
        assert_eq!(place("wind.primitives[1].kind"), (3, 1, 19));
    }

    #[test]
    fn any_span_of_any_text_is_where_counting_finds_it() {
        let long = format!("é\n{}\nü", "aé草\u{1f33e}".repeat(200));
        for text in [TEXT, long.as_str(), "", "\n", "\r\né"] {
            let positions = Positions::new(text);
            for start in 0..text.len() + 3 {
                let fault = positions.spanning(start..start + 3, "", "");
                let before = &text[..floor_char(text, start)];
                let line_start = before.rfind('\n').map_or(0, |at| at + 1);
                assert_eq!(fault.line, before.matches('\n').count() + 1);
                assert_eq!(fault.column, before[line_start..].chars().count() + 1);
                let rest = text[before.len()..floor_char(text, start + 3).max(before.len())].split('\n').next().unwrap();
                assert_eq!(fault.length, rest.chars().count().max(1), "{start}");
            }
        }
    }

    #[test]
    fn long_paths_and_messages_are_cut() {
        let fault = Positions::new("").spanning(0..0, &"é".repeat(300), "m".repeat(3000));
        assert_eq!((fault.path.chars().count(), fault.message.chars().count()), (LONGEST_PATH + 1, LONGEST_MESSAGE + 1));
        assert!(fault.path.ends_with("é…"));
    }
}
