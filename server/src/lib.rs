//! The Prairie server's library.

pub mod objects;
pub mod snapshot;
