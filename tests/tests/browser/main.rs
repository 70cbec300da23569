//! The page in a real browser, and the world behind it.

mod hands;
mod mishaps;
mod page;
mod prairie;
mod share;
mod webgpu;
