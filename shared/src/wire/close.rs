//! Close codes of the WebSocket.

/// Reasons why the server closes a connection. Codes 4000 and up are Prairie's own (RFC 6455, section 7.4.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Close {
    /// The server is stopping (1001); try again later.
    Stopping,
    /// The two sides speak different versions of the protocol (4001); reload the page.
    Version,
    /// A message was malformed, too large, out of order or out of range (4002).
    BadMessage,
    /// Too many messages (4003).
    RateLimit,
    /// The server is full (4004); try again later.
    ServerFull,
    /// No hello came in time (4005).
    NoHello,
    /// The client did not read or acknowledge in time (4006).
    Stalled,
}

impl Close {
    /// All reasons.
    pub const ALL: [Self; 7] =
        [Self::Stopping, Self::Version, Self::BadMessage, Self::RateLimit, Self::ServerFull, Self::NoHello, Self::Stalled];

    /// The code in the close frame.
    pub fn code(self) -> u16 {
        match self {
            Self::Stopping => 1001,
            Self::Version => 4001,
            Self::BadMessage => 4002,
            Self::RateLimit => 4003,
            Self::ServerFull => 4004,
            Self::NoHello => 4005,
            Self::Stalled => 4006,
        }
    }

    /// The reason of a close code; `None` for a code that Prairie does not send.
    pub fn from_code(code: u16) -> Option<Self> {
        Self::ALL.into_iter().find(|close| close.code() == code)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_distinct_and_come_back() {
        for close in Close::ALL {
            assert_eq!(Close::from_code(close.code()), Some(close));
        }
        assert_eq!(Close::from_code(1000), None);
    }
}
