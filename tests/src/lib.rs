//! Support code shared by the tests, charts, pictures and benchmarks of Prairie.

pub mod air;
pub mod arguments;
pub mod browser;
pub mod chart;
pub mod chromedriver;
mod devtools;
pub mod figures;
pub mod limits;
pub mod maps;
pub mod norms;
pub mod orders;
pub mod pages;
pub mod picture;
pub mod prairie;
pub mod problems;
pub mod random_winds;
pub mod similarity;
pub mod slow_line;
pub mod still;
pub mod synthetic;
pub mod texture;
pub mod turntable;
pub mod views;
pub mod worlds;
