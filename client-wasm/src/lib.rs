//! The Prairie client: a wgpu renderer for the browser, and natively without a window.
//!
//! - [`state`]: the mirror of the server that messages are applied to.
//! - [`camera`]: where the picture is taken from; [`rig`]: what moves it.
//! - [`stillness`]: whether a frame would differ from the last; [`budget`]: how fine it may be drawn.
//! - [`controls`]: what hands ask for; [`damped`]: motion that never swings past its goal.
//! - [`render`]: the passes that make the picture.
//! - `browser`, in a page only: socket, hands, frame loop, and what the page's script calls.

#[cfg(target_arch = "wasm32")]
pub mod browser;
pub mod budget;
pub mod camera;
pub mod controls;
pub mod damped;
pub mod render;
pub mod rig;
pub mod state;
pub mod stillness;
