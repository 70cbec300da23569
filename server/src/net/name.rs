//! Display names: visible characters only, so that a name cannot be empty to the eye, imitate another, or disturb the text around it.

use unicode_properties::{GeneralCategoryGroup, UnicodeGeneralCategory};

/// Longest name (characters).
const NAME_LIMIT: usize = 32;

/// Most combining marks on one character: enough for Vietnamese, Thai and Tibetan.
const MARK_LIMIT: usize = 3;

/// Role of a character in a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    Visible,
    /// Drawn on the character before it.
    Mark,
    Space,
    Hidden,
}

/// Display name of a client that calls itself `name`: "guest" and its number if nothing visible is left.
pub(super) fn name_for(client: u32, name: &str) -> String {
    Some(clean(name)).filter(|name| !name.is_empty()).unwrap_or_else(|| format!("guest {client}"))
}

/// A name of visible characters, at most [`NAME_LIMIT`]; single spaces between words, and few marks on each character.
fn clean(name: &str) -> String {
    let mut kept = String::new();
    let (mut room, mut marks, mut before) = (NAME_LIMIT, 0, Role::Space);
    for c in name.chars() {
        let role = role(c);
        match role {
            Role::Hidden => continue,
            // Also drops spaces at the start.
            Role::Space if before == Role::Space => continue,
            // A mark on a space or at the start would be drawn on something outside the name.
            Role::Mark if before == Role::Space || marks == MARK_LIMIT => continue,
            Role::Mark => marks += 1,
            Role::Visible | Role::Space => marks = 0,
        }
        if room == 0 {
            break;
        }
        room -= 1;
        before = role;
        kept.push(if role == Role::Space { ' ' } else { c });
    }
    kept.truncate(kept.trim_end().len());
    kept
}

/// Control characters, formats (direction, zero width), private use and unassigned characters are hidden.
fn role(c: char) -> Role {
    if is_blank(c) {
        return Role::Hidden;
    }
    match c.general_category_group() {
        GeneralCategoryGroup::Letter | GeneralCategoryGroup::Number | GeneralCategoryGroup::Punctuation | GeneralCategoryGroup::Symbol => {
            Role::Visible
        }
        GeneralCategoryGroup::Mark => Role::Mark,
        GeneralCategoryGroup::Separator => Role::Space,
        GeneralCategoryGroup::Other => Role::Hidden,
    }
}

/// Letters, symbols and marks that are drawn as nothing: fillers, the blank Braille pattern, joiners and variation selectors.
fn is_blank(c: char) -> bool {
    matches!(
        c,
        '\u{34f}'
            | '\u{115f}'..='\u{1160}'
            | '\u{17b4}'..='\u{17b5}'
            | '\u{180b}'..='\u{180f}'
            | '\u{2800}'
            | '\u{3164}'
            | '\u{fe00}'..='\u{fe0f}'
            | '\u{ffa0}'
            | '\u{1d159}'
            | '\u{e0100}'..='\u{e01ef}'
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_cleaned_and_truncated() {
        assert_eq!(clean("  Ada\u{7}\n "), "Ada");
        assert_eq!(clean("Ada \u{a0}\u{2003} Lovelace"), "Ada Lovelace");
        assert_eq!(clean(&"ü".repeat(500)).chars().count(), NAME_LIMIT);
        assert_eq!(clean(&format!("{} b", "a".repeat(NAME_LIMIT - 1))), "a".repeat(NAME_LIMIT - 1));
    }

    #[test]
    fn names_in_many_scripts_are_unchanged() {
        for name in ["Nguyễn", "Nguye\u{302}\u{303}n", "李小龍", "Ольга", "مريم", "दिव्या", "น้ำผึ้ง", "བསྒྲུབས", "O’Neill-2", "🦊 fox", "🇩🇪"]
        {
            assert_eq!(clean(name), name);
        }
    }

    #[test]
    fn hidden_characters_are_dropped() {
        for hidden in [
            '\u{202e}',
            '\u{2066}',
            '\u{200b}',
            '\u{200d}',
            '\u{feff}',
            '\u{ad}',
            '\u{e0041}',
            '\u{e000}',
            '\u{378}',
            '\u{10ffff}',
            '\u{fe0f}',
        ] {
            assert_eq!(clean(&format!("A{hidden}da")), "Ada", "U+{:04X}", u32::from(hidden));
        }
    }

    #[test]
    fn a_name_without_anything_visible_becomes_a_guest() {
        for name in ["", " ", "\u{1b}\u{0}", "\u{200b}\u{200b}", "\u{3164}", "\u{2800}", "\u{301}", " \u{301}\u{20dd}", "\u{202e}\u{2028}"]
        {
            assert_eq!(name_for(7, name), "guest 7", "{}", name.escape_unicode());
        }
    }

    #[test]
    fn stacked_marks_are_limited() {
        assert_eq!(clean(&format!("a{}b\u{301}", "\u{301}".repeat(20))), format!("a{}b\u{301}", "\u{301}".repeat(MARK_LIMIT)));
    }
}
