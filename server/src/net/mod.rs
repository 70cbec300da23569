//! The network side of the server.

pub mod assets;
