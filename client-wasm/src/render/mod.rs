//! The renderer: draws a [`Mirror`](crate::state::Mirror) as a [`Camera`](crate::camera::Camera) sees it.
//!
//! `frame` lists the steps of a frame. Each folder uses only the folders above it in this list:
//!
//! - `gpu`: device, pipelines, shader modules, sorting, queries.
//! - `options`: quality presets, level of detail, render options.
//! - `inputs`: uniforms and textures that all passes read.
//! - `land_and_sky`: ground, sky, rain, dust, tone mapping.
//! - `solids`: vehicles, trees and stones, and the shadow cache.
//! - `plants`: blades, underbrush, shells, clumps.

mod frame;
mod gpu;
mod inputs;
mod land_and_sky;
#[cfg(not(target_arch = "wasm32"))]
mod offscreen;
mod options;
mod plants;
mod renderer;
mod scene_resources;
pub(crate) mod solids;
mod stage;
mod targets;

pub use frame::FrameStats;
pub use gpu::device::Gpu;
pub use gpu::error::GpuError;
pub use gpu::limits::fit_within_px;
pub use gpu::pipeline_statistics::{PassStatistics, PipelineStatistics};
pub use gpu::timestamps::PassSecs;
pub use inputs::bend_atlas::reach_m as bend_reach_m;
#[cfg(not(target_arch = "wasm32"))]
pub use offscreen::OffscreenRenderer;
pub use options::quality::{DeviceClass, Quality, REFERENCE_REACH_M};
pub use options::render_options::{BlendOrder, FarPlants, Occlusion, RenderOptions};
pub use options::split::{SideOptions, Split};
pub use prairie_core::light::sun::Sun;
pub use renderer::{NextStage, Renderer};
pub use stage::Stage;

#[cfg(test)]
mod tests;
