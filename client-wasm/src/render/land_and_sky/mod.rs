//! Ground, sky, weather and tone mapping.

pub(crate) mod dust;
pub(crate) mod rain;
pub(crate) mod sky;
pub(crate) mod terrain;
pub(crate) mod tone;
