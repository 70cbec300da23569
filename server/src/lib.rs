//! The Prairie server.

pub mod inspect;
pub mod snapshot;
