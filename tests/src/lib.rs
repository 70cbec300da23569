//! Tests, charts, pictures and benchmarks of Prairie.

pub mod synthetic;
