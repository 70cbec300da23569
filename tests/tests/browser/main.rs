//! The page in a real browser, and the world behind it.

mod access;
mod charts;
mod failures;
mod icons;
mod input;
mod latency;
mod look_back;
mod one_storm;
mod page;
mod prairie;
mod race;
mod replica;
mod scenes;
mod sharing;
mod sound;
mod start;
mod webgpu;
