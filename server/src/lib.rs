//! The Prairie server's library.

pub mod bend;
pub mod net;
pub mod objects;
pub mod snapshot;
pub mod weather;
pub mod wind;
pub mod world;
