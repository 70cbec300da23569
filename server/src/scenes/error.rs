//! Errors of scene files, with file, line and column.

use super::fault_report::draw;
use crate::escaped::escaped;
use annotate_snippets::Renderer;
use prairie_core::scene::SceneFault;
use std::ffi::OsString;
use std::fmt;
use std::path::PathBuf;
use thiserror::Error;

/// Reasons why a scene cannot be loaded.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SceneError {
    /// Neither a built-in scene nor a file.
    #[error("there is no built-in scene and no file called `{}`{} Built-in scenes: {}", escaped(.name), suggestion(*.nearest), .known.join(", "))]
    Unknown {
        /// The requested name.
        name: OsString,
        /// The built-in scene with the most similar name, if any is similar.
        nearest: Option<&'static str>,
        /// Names of all built-in scenes.
        known: Vec<&'static str>,
    },
    /// The scene file cannot be read.
    #[error("scene file `{}` cannot be read: {reason}", escaped(.path))]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The reason.
        reason: String,
    },
    /// The file, or a file that it names, contains faults.
    #[error("{0}")]
    Faulty(FaultyScene),
}

fn suggestion(nearest: Option<&str>) -> String {
    nearest.map_or_else(|| ".".to_owned(), |name| format!("; did you mean `{name}`?"))
}

/// The text of a scene file, or of its underbrush file, with all its faults.
///
/// Displayed on several lines: the number of faults, and for each of the first ones a description, its position, the line of the file, and carets
/// below it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaultyScene {
    /// The file: the scene file as the user named it, or the underbrush file with its folder; escaped.
    pub file: String,
    /// Its text.
    pub text: String,
    /// The faults in the order of the lines; at least one.
    pub faults: Vec<SceneFault>,
}

impl FaultyScene {
    /// The displayed lines in the colours of a terminal.
    pub fn styled(&self) -> String {
        draw(self, &Renderer::styled())
    }
}

impl fmt::Display for FaultyScene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&draw(self, &Renderer::plain()))
    }
}
