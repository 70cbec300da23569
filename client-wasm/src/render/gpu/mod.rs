//! The GPU device, and helpers that every pass uses to create its resources.

pub(crate) mod constants;
pub(crate) mod device;
pub(crate) mod error;
pub(crate) mod f16;
pub(crate) mod flower_kinds;
pub(crate) mod limits;
pub(crate) mod mipmaps;
pub(crate) mod pipeline;
#[cfg_attr(target_arch = "wasm32", expect(dead_code, reason = "only pictures without a window are measured"))]
pub(crate) mod pipeline_statistics;
#[cfg(not(target_arch = "wasm32"))]
pub(crate) mod readback;
pub(crate) mod shaders;
pub(crate) mod sort;
#[cfg_attr(target_arch = "wasm32", expect(dead_code, reason = "only pictures without a window are measured"))]
pub(crate) mod timestamps;
pub(crate) mod uniform_block;
pub(crate) mod uniforms;
pub(crate) mod variants;
