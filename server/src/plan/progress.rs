//! Progress of planning, for people who wait.

use std::io::{IsTerminal as _, Write as _};

/// Listener to the progress of a plan.
pub trait Progress {
    /// A part begins whose length is not known.
    fn start(&mut self, part: &str);
    /// So many pilot runs were made, of at most so many.
    fn ran(&mut self, runs: usize, most: usize);
}

/// Shows nothing.
#[derive(Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn start(&mut self, _: &str) {}

    fn ran(&mut self, _: usize, _: usize) {}
}

/// A line on stderr, if that is a terminal; it is cleared at the end.
#[derive(Debug, Default)]
pub struct Line {
    is_shown: bool,
}

impl Line {
    /// Shows how many of how many measurements are done.
    pub fn bar(&mut self, what: &str, done: usize, all: usize) {
        let full = 30 * done / all.max(1);
        self.show(&format!("{what} [{:<30}] {done} of {all}", "#".repeat(full)));
    }

    fn show(&mut self, text: &str) {
        if std::io::stderr().is_terminal() {
            self.is_shown = true;
            // Nobody can be told when stderr is closed.
            let _ = write!(std::io::stderr(), "\r\x1b[2K{text}");
        }
    }
}

impl Progress for Line {
    fn start(&mut self, part: &str) {
        self.show(&format!("planning: {part}"));
    }

    fn ran(&mut self, runs: usize, most: usize) {
        self.bar("planning: pilot runs", runs, most);
    }
}

impl Drop for Line {
    fn drop(&mut self) {
        if self.is_shown {
            let _ = write!(std::io::stderr(), "\r\x1b[2K");
        }
    }
}
