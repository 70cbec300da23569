//! Reference solutions for plants: blades in a recorded gust, components as heavy elasticas.

mod gust;

pub use gust::{BLADE, Gust, PLACES};
