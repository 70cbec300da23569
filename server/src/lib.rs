//! placeholder

pub mod net;
pub mod wind;
