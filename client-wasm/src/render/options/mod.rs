//! Quality presets, level of detail and render options.

pub(crate) mod detail;
pub(crate) mod quality;
pub(crate) mod render_options;
pub(crate) mod split;
