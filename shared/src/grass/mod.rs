//! Grass under objects and winds (Chen & Johan, sections 4 and 5): active regions, contact, prescribed winds and flattened grass, around the
//! [bend field](crate::bend).
//!
//! A step is determined by the state before it, its [causes](Causes) and the [wind](crate::wind::WindField), to the last bit on every machine. So a server and
//! its clients simulate the same grass when the clients know the causes.

mod audience;
pub mod bending;
mod bodies;
mod camera;
mod causes;
mod codes;
pub mod contact;
mod corner_contact;
pub mod flattened;
pub mod footprint;
pub mod grass_properties;
pub mod grass_state;
mod gust_noise;
mod gust_pattern;
pub mod prescribed_wind;
mod regions;
mod repeated_patch;
mod replica;
mod simulation;
pub mod snow;
mod step_codec;
pub mod stroke;
pub mod swept_footprint;
pub mod vector;
pub mod wind_drawing;

pub use audience::Audience;
pub use camera::Camera;
pub use causes::Causes;
pub use codes::{BentPatches, PatchCodes, PatchQuantiser};
pub use gust_noise::patches_within;
pub use repeated_patch::RepeatedPatch;
pub use replica::{Replica, ReplicaError, ReplicaState, STATE_LIMIT_BYTES};
pub use simulation::{BendSimulation, BendState};
pub use step_codec::{DecodeError, DecodedStep, EncodedSteps, OBJECT_LIMIT, StepCodec, StepRecord};
