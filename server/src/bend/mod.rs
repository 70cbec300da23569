//! Threads, checks and step errors of the bend field, which is simulated by [`prairie_core::grass`].

pub(crate) mod halving;
pub mod pool;
pub mod stability;
