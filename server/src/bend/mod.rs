//! The bend field and the forces on it (Chen & Johan, sections 4 and 5): active regions, contact, wind, propagation.

pub mod bending;
mod bodies;
mod camera;
pub mod contact;
pub mod flattened;
pub mod footprint;
pub mod grass_properties;
pub mod grass_state;
mod gust_noise;
pub mod pool;
pub mod prescribed_wind;
mod regions;
mod simulation;
pub mod stability;
pub mod swept_footprint;
pub(crate) mod vector;
pub mod wind_drawing;

pub use camera::Camera;
pub use simulation::{BendSimulation, BendState};
