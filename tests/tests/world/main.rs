//! The world as a whole, its scenes, and the structure of the packages.

mod architecture;
mod balls;
mod breaking;
mod broken_scenes;
mod chase_camera;
mod codes;
mod determinism;
mod documents;
mod driving;
mod functions;
mod imports;
mod licences;
mod look_back;
mod models;
mod pictures;
mod posts;
mod prediction;
mod replica;
mod same_plants;
mod shipped_species;
mod snow;
