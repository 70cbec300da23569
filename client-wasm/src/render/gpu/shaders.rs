//! Shader modules of all passes, linked from the files in `shaders/` by the build script.

use std::fmt;

use super::uniform_block::{Block, UniformBlock as _};
use super::{constants, uniforms};

include!(concat!(env!("OUT_DIR"), "/shaders.rs"));

/// WGSL module of a pass. Each line of its text ends with a comment that names its source file and line, so that the errors of compilers show them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shader {
    /// File with the entry points, as a path below `shaders/` without extension.
    #[cfg_attr(not(test), expect(dead_code, reason = "names the pass in failed tests"))]
    pub(crate) file: &'static str,
    pieces: &'static [Piece],
}

#[derive(Clone, Copy, Debug)]
enum Piece {
    Wgsl(&'static Text),
    Constant(&'static str, &'static dyn constants::Constant),
    Block(&'static Block),
}

/// A declaration copied from a file, with its first line.
#[derive(Debug)]
struct Text {
    file: &'static str,
    line: usize,
    text: &'static str,
}

impl fmt::Display for Shader {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut declared = Vec::new();
        self.pieces.iter().try_for_each(|piece| piece.declare(&mut declared, f))
    }
}

impl Piece {
    /// Writes its declaration; that of a block only if it is not yet in `declared`.
    fn declare(self, declared: &mut Vec<&'static str>, out: &mut impl fmt::Write) -> fmt::Result {
        match self {
            Self::Wgsl(text) => write_lines(out, text.file, text.line, text.text),
            Self::Constant(name, value) => writeln!(out, "{}", value.declaration(name)),
            Self::Block(block) => block.declare(declared, out),
        }
    }
}

fn write_lines(out: &mut impl fmt::Write, file: &str, first: usize, text: &str) -> fmt::Result {
    (first..).zip(text.lines()).filter(|(_, line)| !line.is_empty()).try_for_each(|(at, line)| writeln!(out, "{line} // {file}.wgsl:{at}"))
}

/// Value of an `override` of a module.
pub(crate) type Constant = (&'static str, bool);

/// Text of a module with the values of its overrides written into it. Browsers differ in whether a pipeline may set an override that its entry points do
/// not read. Values of overrides that only other modules have are ignored.
///
/// # Panics
/// If no file declares an override of that name.
pub(crate) fn with_constants(text: String, constants: &[Constant]) -> String {
    constants.iter().fold(text, |text, (name, value)| {
        let declared = [true, false].map(|usual| format!("override {name}: bool = {usual};"));
        let Some(found) = declared.iter().find(|declared| text.contains(*declared)) else {
            assert!(OVERRIDES.contains(name), "{name} is an override");
            return text;
        };
        text.replace(found, &format!("const {name}: bool = {value};"))
    })
}

#[cfg(test)]
pub(crate) mod tests;
