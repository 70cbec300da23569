//! Grass, flowers and underbrush.

pub(crate) mod billboards;
pub(crate) mod blades;
pub(crate) mod blending;
pub(crate) mod clump_pipelines;
pub(crate) mod clump_texture;
pub(crate) mod force_field;
pub(crate) mod grid_map;
mod grid_map_legend;
pub(crate) mod obstacles;
pub(crate) mod per_blend_order;
pub(crate) mod shell_texture;
pub(crate) mod shells;
pub(crate) mod underbrush;
pub(crate) mod weighted_oit;
