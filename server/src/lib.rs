//! The Prairie server.

pub mod wind;
