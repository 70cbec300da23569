//! What can be wrong with a scene, said so that it can be mended.

use shared::scene::SceneFault;
use std::fmt;
use std::path::PathBuf;
use thiserror::Error;

/// Why a scene cannot be loaded.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SceneError {
    /// Neither a built-in scene nor a file.
    #[error("no built-in scene and no file is called `{name}`{} Built-in scenes: {}", meant(*.nearest), .known.join(", "))]
    Unknown {
        /// What was asked for.
        name: String,
        /// The built-in scene whose name is most like it, if one is.
        nearest: Option<&'static str>,
        /// All built-in scenes.
        known: Vec<&'static str>,
    },
    /// The scene file cannot be read.
    #[error("scene file `{}` cannot be read: {reason}", .path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// The file was read, and something in it or in a file that it names is wrong.
    #[error("{0}")]
    Faulty(FaultyScene),
}

fn meant(nearest: Option<&str>) -> String {
    nearest.map_or_else(|| ".".to_owned(), |name| format!("; did you mean `{name}`?"))
}

/// The text of a scene file, or of its underbrush file, with everything that is wrong in it.
///
/// Displayed over several lines: for each fault the place, what is wrong, the line of the file and carets below it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaultyScene {
    /// The file: the scene's as it was named, that of the underbrush with its folder.
    pub file: String,
    /// Its text.
    pub text: String,
    /// What is wrong, in the order of the lines; at least one fault.
    pub faults: Vec<SceneFault>,
}

impl fmt::Display for FaultyScene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = self.faults.len();
        writeln!(f, "{} has {count} fault{}", self.file, if count == 1 { "" } else { "s" })?;
        for fault in &self.faults {
            let SceneFault { line, column, length, .. } = fault;
            let source = self.text.lines().nth(line - 1).unwrap_or_default();
            let number = line.to_string();
            let gutter = " ".repeat(number.len());
            let shown: String = source.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
            let carets = format!("{}{}", " ".repeat(column - 1), "^".repeat(*length));
            write!(f, "\n{}:{line}:{column}: {fault}", self.file)?;
            write!(f, "\n{gutter} |\n{number} | {shown}\n{gutter} | {carets}\n")?;
        }
        Ok(())
    }
}
