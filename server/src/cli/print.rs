//! Printing to stdout and stderr, which may be closed or full.

use anyhow::Context as _;
use std::fmt::Display;
use std::io::{self, ErrorKind, Write as _};

/// Prints text and a line end to stdout. Colours are left out where stdout is not a terminal, or where `NO_COLOR` is set. A closed pipe is not an error: its
/// reader, such as `head`, has read enough.
///
/// # Errors
/// When stdout cannot be written, for example because its disk is full.
pub(super) fn print(text: impl Display) -> anyhow::Result<()> {
    let printed = print_exactly(format_args!("{text}\n"));
    if printed.as_ref().is_err_and(is_closed_pipe) { Ok(()) } else { printed.context("cannot write to stdout") }
}

/// Prints text to stdout; a closed pipe is an error like any other.
///
/// # Errors
/// When stdout cannot be written.
pub(super) fn print_exactly(text: impl Display) -> io::Result<()> {
    let mut stdout = anstream::AutoStream::auto(io::stdout().lock());
    write!(stdout, "{text}")?;
    stdout.flush()
}

/// Whether the reader of the pipe has closed it.
pub(super) fn is_closed_pipe(error: &io::Error) -> bool {
    error.kind() == ErrorKind::BrokenPipe
}

/// Prints an error to stderr; if that fails, nobody can be told.
pub(crate) fn complain(error: &anyhow::Error) {
    let _ = writeln!(io::stderr(), "error: {error:#}");
}
