//! The Prairie client: a wgpu renderer for the browser, and natively without a window.

#[cfg(target_arch = "wasm32")]
mod entry;
