//! The Prairie client: a wgpu renderer for the browser, and natively without a window.
//!
//! - [`state`]: the mirror of the server that messages are applied to.
//! - [`camera`]: where the picture is taken from.
//! - [`render`]: the passes that make the picture.

pub mod camera;
#[cfg(target_arch = "wasm32")]
mod entry;
pub mod render;
pub mod state;
