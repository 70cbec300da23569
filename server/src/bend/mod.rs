//! Threads and checks of the bend field, which is simulated by [`prairie_core::grass`].

pub mod pool;
pub mod stability;
