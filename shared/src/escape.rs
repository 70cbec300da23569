//! Escapes for text from outside that is printed in messages.

use std::borrow::Cow;

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
    fn only_what_cannot_be_seen_is_escaped() {
        assert!(matches!(escape_invisible("Grüße, 草.toml"), Cow::Borrowed("Grüße, 草.toml")));
        assert_eq!(escape_invisible("a\u{1b}[31m\nb\u{202e}c\u{9b}"), "a\\u{1b}[31m\\nb\\u{202e}c\\u{9b}");
    }
}
