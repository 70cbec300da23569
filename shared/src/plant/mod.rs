//! Plants: blades of grass (Zhang chapter 3), underbrush of leaves, branches and flowers (Endo et al. 2003) and where it grows, trees of the same
//! components.

pub mod blade;
pub mod flora;
pub mod force_field;
pub mod growth;
pub mod snow_load;
pub mod tree;
pub mod underbrush;
