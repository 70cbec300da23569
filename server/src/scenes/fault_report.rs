//! Drawing of the faults of a scene file.

use super::error::FaultyScene;
use annotate_snippets::{Annotation, AnnotationKind, Group, Level, Origin, Renderer, Snippet};
use prairie_core::scene::SceneFault;
use std::fmt::Write as _;
use std::ops::Range;

/// Most faults that are drawn, the first ones; the others are counted.
pub(super) const DRAWN_LIMIT: usize = 20;

/// Maximum length of a line (bytes) for the renderer; longer ones are cut. It shows only the part that fits, but its time grows with the line.
const LONG_LINE: usize = 1000;

/// Number of characters of a longer line that are handed over on each side of the fault, more than are shown.
const WINDOW: usize = 300;

/// A line with the number of faults, then each of the first faults: its description, its position, the line of the file, and carets below it.
pub(super) fn draw(faulty: &FaultyScene, renderer: &Renderer) -> String {
    let FaultyScene { file, text, faults } = faulty;
    let count = faults.len();
    let mut drawing = format!("{file} has {count} fault{}\n", if count == 1 { "" } else { "s" });
    let mut lines = text.lines().enumerate();
    let mut current = (0, "");
    for fault in faults.iter().take(DRAWN_LIMIT) {
        if current.0 != fault.line {
            let found = lines.find(|(index, _)| index + 1 == fault.line);
            current = (fault.line, found.map_or("", |(_, line)| line));
        }
        let _ = write!(drawing, "\n{}\n", renderer.render(&[draw_fault(file, current.1, fault)]));
    }
    if let Some(more) = count.checked_sub(DRAWN_LIMIT).filter(|&more| more > 0) {
        let _ = writeln!(drawing, "\nand {more} more fault{}", if more == 1 { "" } else { "s" });
    }
    drawing
}

fn draw_fault<'a>(file: &'a str, line: &'a str, fault: &SceneFault) -> Group<'a> {
    let title = Group::with_title(Level::ERROR.primary_title(fault.to_string()));
    let byte = |character: usize| line.char_indices().nth(character).map_or(line.len(), |(at, _)| at);
    let (start, length) = (fault.column - 1, fault.length.min(WINDOW));
    let span = byte(start)..byte(start + length);
    if line.len() <= LONG_LINE {
        return title.element(Snippet::source(line).line_start(fault.line).path(file).annotation(carets(span)));
    }
    let window = byte(start.saturating_sub(WINDOW))..byte(start + length + WINDOW);
    let span = span.start - window.start..span.end - window.start;
    title
        .element(Origin::path(file).line(fault.line).char_column(fault.column))
        .element(Snippet::source(&line[window]).line_start(fault.line).annotation(carets(span)))
}

fn carets<'a>(span: Range<usize>) -> Annotation<'a> {
    AnnotationKind::Primary.span(span)
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::scene::parse;

    fn drawn(text: &str) -> String {
        let faulty = FaultyScene { file: "s.toml".to_owned(), text: text.to_owned(), faults: parse(text).unwrap_err() };
        draw(&faulty, &Renderer::plain())
    }

    #[test]
    fn a_fault_on_a_long_line_is_drawn_with_the_text_around_it() {
        let key = |i| format!("\"é{i}\" = 1, ");
        let keys: String = (0..2000).map(key).collect();
        let drawn = drawn(&format!("wind = {{ {keys} mean_m_per_s = 7 }}\n"));
        assert!(drawn.starts_with("s.toml has 2003 faults\n"), "{drawn}");
        assert!(drawn.lines().filter(|line| !line.starts_with("error: ")).all(|line| line.chars().count() <= 150), "{drawn}");
        assert!(drawn.contains("`wind.é0` is not a field of a scene; known here: `advection`,"), "{drawn}");
        assert!(drawn.contains(" --> s.toml:1:10\n"), "{drawn}");
        assert_eq!(drawn.matches("error: ").count(), DRAWN_LIMIT);
        assert!(drawn.ends_with("\nand 1983 more faults\n"), "{drawn}");
    }

    #[test]
    fn faults_far_into_a_line_are_cut_on_both_sides() {
        let text = format!("summary = \"s\"\nseed = [{}]\n", "1, ".repeat(100_000));
        let faulty = FaultyScene {
            file: "s.toml".to_owned(),
            faults: vec![prairie_core::scene::SceneFault {
                line: 2,
                column: 150_000,
                length: 200_000,
                path: String::new(),
                message: "m".to_owned(),
            }],
            text,
        };
        let drawn = draw(&faulty, &Renderer::plain());
        assert!(drawn.contains(" --> s.toml:2:150000\n") && drawn.contains("\n2 | ...") && drawn.contains("^^^^"), "{drawn}");
        assert!(drawn.len() < 1000, "{drawn}");
    }

    #[test]
    fn no_escape_sequence_of_a_file_is_drawn() {
        let drawn = drawn("\"a\\u001b[31m\" = 1 # \u{202e}\t\n");
        assert!(drawn.contains("`a\\u{1b}[31m` is not a field"), "{drawn}");
        assert!(!drawn.contains(['\u{1b}', '\u{202e}', '\t']), "{drawn}");
    }
}
