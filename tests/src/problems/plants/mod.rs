//! What plants are compared with: blades in a gust of the wind's own, components by the heavy elastica.

mod elastica;
mod gust;

pub use elastica::heavy_elastica;
pub use gust::{ABREAST, BLADE, Gust, PLACES};
