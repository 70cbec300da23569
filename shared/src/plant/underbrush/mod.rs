//! Underbrush: plants made of leaves, branches and flowers that bend under their weight and the force field (004).
//!
//! [`section`] and [`rest`] say how a component bends, 004's way and in full balance, [`strength`] what breaks it, [`bearing`] what a species bears.
//! [`posture`] holds that in tables, by the direction and the size of the load; [`plan`] makes the tables of a species and says which components its plants
//! have. A plant is then [`plant::posed`] by the force that it feels, which follows the force field as [`constraint`] says, and drawn from the [`vectors`] of
//! its components. [`drops`] of rain strike them one by one.

pub mod bearing;
pub mod constraint;
pub mod drops;
pub mod plan;
pub mod plant;
pub mod posture;
pub mod rest;
pub mod section;
#[cfg(test)]
mod species;
pub mod strength;
pub mod vectors;
