//! The Prairie client: a wgpu renderer for the browser, and natively without a window.

pub mod controls;
pub mod damped;
pub mod link;
pub mod playback;
pub mod rig;
