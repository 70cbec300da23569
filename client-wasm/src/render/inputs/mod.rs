//! Inputs that passes share: uniforms, view, light, and textures of the scene.

pub(crate) mod bend_atlas;
pub(crate) mod canvas;
pub(crate) mod cascades;
pub(crate) mod daylight;
pub(crate) mod depth_pyramid;
pub(crate) mod dusty_cells;
pub(crate) mod frame_bindings;
pub(crate) mod frustum;
pub(crate) mod grass_kinds;
pub(crate) mod lamps;
pub(crate) mod lowest_land;
pub(crate) mod noise_texture;
pub(crate) mod random;
pub(crate) mod repeated_patch;
pub(crate) mod view;
pub(crate) mod viewpoint;
pub(crate) mod wind_texture;
