//! Legend of the map of the grids: its lines, and the pixels of its characters.

use crate::render::gpu::constants::{GLYPH_HEIGHT, GLYPH_WIDTH, GRID_CLASSES, LEGEND_CHARACTERS};

/// Line of each class.
const LINES: [&str; GRID_CLASSES as usize] = [
    "SIMULATED BLADES",
    "SINGLE BLADES",
    "CLUMPS OF 3",
    "CLUMPS OF 5",
    "CLUMPS OF 9",
    "CLUMPS OF 17 UP",
    "CULLED BY VIEW",
    "CULLED BY HILLS",
];

/// Digits in order, then the letters of the legend, each with its rows of three pixels from the top, `#` set.
const GLYPHS: &[(char, [&str; GLYPH_HEIGHT as usize])] = &[
    ('0', ["###", "# #", "# #", "# #", "###"]),
    ('1', [" # ", "## ", " # ", " # ", "###"]),
    ('2', ["###", "  #", "###", "#  ", "###"]),
    ('3', ["###", "  #", " ##", "  #", "###"]),
    ('4', ["# #", "# #", "###", "  #", "  #"]),
    ('5', ["###", "#  ", "###", "  #", "###"]),
    ('6', ["###", "#  ", "###", "# #", "###"]),
    ('7', ["###", "  #", " # ", " # ", " # "]),
    ('8', ["###", "# #", "###", "# #", "###"]),
    ('9', ["###", "# #", "###", "  #", "###"]),
    ('A', [" # ", "# #", "###", "# #", "# #"]),
    ('B', ["## ", "# #", "## ", "# #", "## "]),
    ('C', [" ##", "#  ", "#  ", "#  ", " ##"]),
    ('D', ["## ", "# #", "# #", "# #", "## "]),
    ('E', ["###", "#  ", "## ", "#  ", "###"]),
    ('F', ["###", "#  ", "## ", "#  ", "#  "]),
    ('G', [" ##", "#  ", "# #", "# #", " ##"]),
    ('H', ["# #", "# #", "###", "# #", "# #"]),
    ('I', ["###", " # ", " # ", " # ", "###"]),
    ('L', ["#  ", "#  ", "#  ", "#  ", "###"]),
    ('M', ["# #", "###", "###", "# #", "# #"]),
    ('N', ["## ", "# #", "# #", "# #", "# #"]),
    ('O', [" # ", "# #", "# #", "# #", " # "]),
    ('P', ["## ", "# #", "## ", "#  ", "#  "]),
    ('S', [" ##", "#  ", " # ", "  #", "## "]),
    ('T', ["###", " # ", " # ", " # ", " # "]),
    ('U', ["# #", "# #", "# #", "# #", "###"]),
    ('V', ["# #", "# #", "# #", "# #", " # "]),
    ('W', ["# #", "# #", "###", "###", "# #"]),
    ('Y', ["# #", "# #", " # ", " # ", " # "]),
];

/// Pixels of the ten digits, then of the characters of the legend, line by line. Bit n is pixel n, row by row from the top left.
pub(crate) fn glyphs() -> Vec<u32> {
    let digits = GLYPHS[..10].iter().map(|&(digit, _)| pixels(digit));
    let lines = LINES.iter().flat_map(|line| line.chars().chain(std::iter::repeat(' ')).take(LEGEND_CHARACTERS as usize).map(pixels));
    digits.chain(lines).collect()
}

/// Pixels of a character; none for a space.
fn pixels(character: char) -> u32 {
    let rows = GLYPHS.iter().filter(|(known, _)| *known == character).flat_map(|(_, rows)| rows);
    let set = rows.flat_map(|row| row.bytes().take(GLYPH_WIDTH as usize)).enumerate().filter(|(_, pixel)| *pixel == b'#');
    set.fold(0, |pixels, (at, _)| pixels | 1 << at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_character_of_the_legend_has_its_own_glyph() {
        for line in LINES {
            assert!(line.len() <= LEGEND_CHARACTERS as usize, "{line}");
            for character in line.chars() {
                assert_eq!(pixels(character) == 0, character == ' ', "{character} in {line}");
            }
        }
        let mut all: Vec<u32> = GLYPHS.iter().map(|&(character, _)| pixels(character)).collect();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), GLYPHS.len(), "two characters look alike");
        assert_eq!(pixels('T'), 0b010_010_010_010_111);
        assert_eq!(glyphs().len(), 10 + LINES.len() * LEGEND_CHARACTERS as usize);
    }
}
