//! Vehicles and balls: rigid bodies, their controls, and the terrain under them.
//!
//! The server moves all objects by this package, and the browser client predicts its own vehicle by the same step. It is pure: no clock, file or network.

mod dynamics;
mod environment;
mod kinds;
mod lone_vehicle;
mod terrain_colliders;
mod vehicle;

pub use dynamics::{Airflow, ControlStep, Controller, VehicleDynamics};
pub use environment::Environment;
pub use kinds::{airflow, bodies, dynamics, prisms, trail_rgb};
pub use lone_vehicle::{LoneVehicle, VehicleMotion};
pub use terrain_colliders::{TerrainColliders, TileIndex};
pub use vehicle::{SPEED_LIMIT_M_PER_S, Vehicle, pose};

/// The README's example.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeExample;
