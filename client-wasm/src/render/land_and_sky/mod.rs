//! Ground, sky, weather and tone mapping.

pub(crate) mod dust;
pub(crate) mod plain_ground;
pub(crate) mod rain;
pub(crate) mod shade_map;
pub(crate) mod sky;
pub(crate) mod terrain;
pub(crate) mod terrain_quadtree;
pub(crate) mod tone;
