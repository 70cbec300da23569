//! Underbrush: plants made of leaves, branches and flowers that bend under their weight and the force field (Endo et al. 2003).
//!
//! - [`section`], [`rest`] and [`elastica`]: bending of one section, of a component, and of the exact beam.
//! - [`strength`] and [`bearing`]: breaking loads of a component and of a species.
//! - [`posture`]: tables of bent shapes by direction and size of the load.
//! - [`plan`]: the tables of a species, and the components of each of its plants.
//! - [`constraint`]: delayed response to the force field; [`drops`]: response to single raindrops.
//! - [`plant`]: shape of a plant under given forces; [`vectors`]: its outline, from which it is drawn, and [`spline`]: its curve close up.

pub mod bearing;
pub mod constraint;
pub mod drops;
pub mod elastica;
pub mod plan;
pub mod plant;
pub mod posture;
pub mod rest;
pub mod section;
pub mod spline;
pub mod strength;
pub mod vectors;
