//! The world as a whole, the scenes that it is made from, and how its crates stand to each other.

mod architecture;
mod balls;
mod breaking;
mod broken_scenes;
mod determinism;
mod driving;
mod same_plants;
