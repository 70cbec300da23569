//! Kinds of files that take the fields of a run.

use super::error::OutputError;
use super::sampler::Frame;

/// Files that take one frame after another.
pub trait Sink: Send {
    /// Writes the values of the sampler's variables at a later time than before.
    ///
    /// # Errors
    /// When a file cannot be written.
    fn write(&mut self, frame: &Frame) -> Result<(), OutputError>;

    /// Completes the files, which can be read up to the newest frame.
    ///
    /// # Errors
    /// When a file cannot be written.
    fn finish(self: Box<Self>) -> Result<(), OutputError>;
}
