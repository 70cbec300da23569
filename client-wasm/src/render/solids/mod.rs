//! Vehicles, trees, stones and gates, and their shadows.

pub(crate) mod bounding_sphere;
pub(crate) mod gates;
pub(crate) mod grown_trees;
pub(crate) mod instances;
pub(crate) mod leaf_texture;
pub(crate) mod limb_passes;
pub(crate) mod mesh;
pub(crate) mod model_meshes;
pub(crate) mod objects;
pub(crate) mod occlusion;
pub(crate) mod shadow_cache;
pub(crate) mod spatial_index;
pub(crate) mod trees_and_stones;
pub(crate) mod vehicles;
