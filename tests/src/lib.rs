//! placeholder
pub mod worlds;
