//! Text from outside that is printed in messages: escapes, and a bound on its length.

use std::borrow::Cow;

/// Longest text from outside that a message repeats (characters).
pub const EXCERPT_LIMIT: usize = 1000;

/// Excerpt of a text with invisible characters escaped: above [`EXCERPT_LIMIT`] the middle is left out, and beginning and end remain.
pub fn excerpt(text: &str) -> String {
    const HALF: usize = EXCERPT_LIMIT / 2;
    let Some((head, _)) = text.char_indices().nth(HALF).filter(|_| text.chars().nth(EXCERPT_LIMIT).is_some()) else {
        return escape_invisible(text).into_owned();
    };
    let tail = text.char_indices().rev().nth(HALF - 1).map_or(text.len(), |(at, _)| at);
    format!("{}…{}", escape_invisible(&text[..head]), escape_invisible(&text[tail..]))
}

/// The text with invisible characters replaced by escapes such as `\u{1b}`: control characters, which may drive a terminal, and those that turn or hide
/// the text around them.
pub fn escape_invisible(text: &str) -> Cow<'_, str> {
    if !text.contains(is_invisible) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 8);
    for character in text.chars() {
        if is_invisible(character) { shown.extend(character.escape_default()) } else { shown.push(character) }
    }
    Cow::Owned(shown)
}

/// Whether a character shows nothing by itself: a control character, a line separator, or a mark of zero width or of direction.
fn is_invisible(character: char) -> bool {
    character.is_control()
        || matches!(character, '\u{ad}' | '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_text_keeps_its_ends() {
        let told = excerpt(&format!("is \"{}\"; allowed: a name", "é".repeat(10_000)));
        assert!(told.starts_with("is \"éé") && told.ends_with("éé\"; allowed: a name") && told.contains("é…é"), "{told}");
        assert_eq!(told.chars().count(), EXCERPT_LIMIT + 1);
        let fits = "ü".repeat(EXCERPT_LIMIT);
        assert_eq!(excerpt(&fits), fits);
    }

    #[test]
    fn only_invisible_characters_are_escaped() {
        assert!(matches!(escape_invisible("Grüße, 草.toml"), Cow::Borrowed("Grüße, 草.toml")));
        assert_eq!(escape_invisible("a\u{1b}[31m\nb\u{202e}c\u{9b}"), "a\\u{1b}[31m\\nb\\u{202e}c\\u{9b}");
    }
}
