//! Reasons why a session ends.

use prairie_core::wire::Close;

/// Reasons why a session ended.
#[derive(Debug)]
pub(super) enum End {
    /// The client closed the connection.
    Left,
    /// The connection broke.
    Broken,
    /// The client is back on another connection.
    Replaced,
    /// The server closes the connection, with a code and a reason.
    Closed(Close, String),
}

impl End {
    /// The client sent something that is not allowed.
    pub(super) fn bad(reason: impl std::fmt::Display) -> Self {
        Self::Closed(Close::BadMessage, reason.to_string())
    }
}
