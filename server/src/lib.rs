//! placeholder

pub mod net;
pub mod scenes;
