//! Rate limit for log messages, and excerpts of what clients send, so that no client can fill the log.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Minimum time between two log messages of the same kind.
const LOG_INTERVAL: Duration = Duration::from_secs(10);

/// Most bytes of a client's text in the log.
const EXCERPT_BYTES: usize = 60;

/// Rate limit for one kind of log message: by default one in [`LOG_INTERVAL`].
#[derive(Debug)]
pub(crate) struct LogLimit {
    per_interval: u32,
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    interval_began: Option<Instant>,
    logged: u32,
    suppressed: u64,
}

impl Default for LogLimit {
    fn default() -> Self {
        Self::of(1)
    }
}

impl LogLimit {
    /// At most `per_interval` messages in [`LOG_INTERVAL`].
    pub(crate) fn of(per_interval: u32) -> Self {
        Self { per_interval, state: Mutex::default() }
    }

    /// Number of messages suppressed since the last one that was due, if another is due; otherwise counts this one as suppressed.
    pub(crate) fn due(&self) -> Option<u64> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        if state.interval_began.is_none_or(|at| at.elapsed() > LOG_INTERVAL) {
            (state.interval_began, state.logged) = (Some(Instant::now()), 0);
        }
        if state.logged >= self.per_interval {
            state.suppressed += 1;
            return None;
        }
        state.logged += 1;
        Some(std::mem::take(&mut state.suppressed))
    }
}

/// The first [`EXCERPT_BYTES`] bytes of a client's text, escaped, with the length of a longer text.
pub(crate) fn excerpt(text: &[u8]) -> String {
    match text.get(..EXCERPT_BYTES) {
        Some(start) if start.len() < text.len() => format!("{}… ({} bytes)", start.escape_ascii(), text.len()),
        _ => text.escape_ascii().to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_suppressed_and_counted() {
        let limit = LogLimit::default();
        assert_eq!([limit.due(), limit.due(), limit.due()], [Some(0), None, None]);
        limit.state.lock().unwrap().interval_began = None;
        assert_eq!([limit.due(), limit.due()], [Some(2), None]);
        let several = LogLimit::of(2);
        assert_eq!([several.due(), several.due(), several.due()], [Some(0), Some(0), None]);
    }

    #[test]
    fn excerpts_are_short_and_escaped() {
        assert_eq!(excerpt(b"http://elsewhere.example"), "http://elsewhere.example");
        assert_eq!(excerpt("\u{1b}[2J\n\u{202e}".as_bytes()), "\\x1b[2J\\n\\xe2\\x80\\xae");
        assert_eq!(excerpt(&[b'x'; 60]), "x".repeat(60));
        assert_eq!(excerpt(&vec![b'x'; 60_000]), format!("{}… (60000 bytes)", "x".repeat(60)));
    }
}
