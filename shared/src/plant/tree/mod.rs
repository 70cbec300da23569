//! Trees made of components: a skeleton that grows by space colonisation, whose trunk, limbs and twigs bend like the components of
//! [underbrush](super::underbrush).
//!
//! - [`colonise`]: growth of the nodes of a skeleton into the crown.
//! - [`skeleton`]: trunk, limbs and twigs of the nodes, with their radii.
//! - [`statics`]: mass, drag and rigidity of each, as a plan with its placed components.

pub mod colonise;
pub mod skeleton;
pub mod statics;
