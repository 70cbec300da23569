//! Plants: blades of grass (000 chapter 3), underbrush of leaves, branches and flowers (004), and where they grow.

pub mod blade;
pub mod flora;
pub mod force_field;
pub mod growth;
pub mod underbrush;
