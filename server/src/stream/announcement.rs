//! Messages that all clients get whole whenever their content changes.

use crate::token_bucket::TokenBucket;
use bytes::Bytes;
use prairie_core::wire::{self, ServerMessage};
use std::time::Instant;

/// Maximum fraction of a client's data rate for announcements of a kind. All clients get each of them, so one client that often changes its name would cost much.
const FRACTION: f64 = 0.1;

/// Number of kinds of announcements: roster, race, ghost.
pub(super) const ANNOUNCEMENTS: usize = 3;

/// A message for all clients, with its version.
#[derive(Clone, Debug, Default)]
pub struct Announced {
    /// Increases with each change; 0 before the first.
    pub version: u64,
    /// The encoded message, empty before the first change.
    pub message: Bytes,
}

/// The content of a message for all clients, and its newest encoding.
#[derive(Debug, Default)]
pub(super) struct Announcement<T> {
    content: T,
    newest: Announced,
    /// Bytes that each client may be sent; filled from the first update on.
    budget: Option<TokenBucket>,
}

impl<T: PartialEq> Announcement<T> {
    /// Encodes the content again if it has changed and the budget, a fraction of `bytes_per_s`, allows; otherwise the change waits. Returns the newest message.
    pub(super) fn update(
        &mut self,
        bytes_per_s: f64,
        now: Instant,
        content: impl FnOnce() -> T,
        message: impl FnOnce(&T) -> ServerMessage,
    ) -> Announced {
        let rate_per_s = FRACTION * bytes_per_s;
        let budget = self.budget.get_or_insert_with(|| TokenBucket::new(rate_per_s, rate_per_s, now));
        budget.fill(now);
        if budget.is_solvent() {
            let content = content();
            if content != self.content {
                self.newest = Announced { version: self.newest.version + 1, message: wire::encode(&message(&content)).into() };
                budget.charge(self.newest.message.len() as f64);
                self.content = content;
            }
        }
        self.newest.clone()
    }
}
