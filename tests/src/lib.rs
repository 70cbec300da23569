//! Tests, charts, pictures and benchmarks of Prairie.

pub mod norms;
pub mod problems;
