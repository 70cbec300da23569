//! Support code shared by the tests, charts, pictures and benchmarks of Prairie.

pub mod arguments;
pub mod browser;
pub mod chart;
pub mod chromedriver;
mod devtools;
pub mod figures;
pub mod maps;
pub mod pages;
pub mod prairie;
pub mod slow_line;
pub mod synthetic;
