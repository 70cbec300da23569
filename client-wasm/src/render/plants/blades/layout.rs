//! Sizes and bind group layouts that the files of the blades share.

pub(super) use crate::render::gpu::constants::CHUNK;
use crate::render::gpu::constants::{self, FAR_HEAD_LIST, HEAD_LIST, LEAST_DENSITY_DISTANCE_M, PLANT_LISTS};
use crate::render::gpu::pipeline::{PassFactory, storage, texture, uniform};

/// Bytes of a drawn blade and of its sway in WGSL.
pub(crate) const BLADE_BYTES: u64 = 112;
pub(crate) const SWAY_BYTES: u64 = 48;
/// Maximum number of listed plants: WebGPU guarantees bindings of 128 MiB.
pub(super) const LISTED_LIMIT: u32 = ((128 << 20) / BLADE_BYTES) as u32;
/// Maximum number of plants per batch, and so per list, in frames that are drawn in batches.
pub(super) const BATCH_LIMIT: u32 = LISTED_LIMIT / 3;
/// Draw lists: fine blades, coarse blades, blades of one segment, near flower heads, far flower heads.
pub(super) const LISTS: usize = PLANT_LISTS as usize;
pub(super) const HEADS: [usize; 2] = [HEAD_LIST as usize, FAR_HEAD_LIST as usize];
pub(super) const STRIPS: usize = 3;
/// Simulated grids around the camera.
pub(super) const NEAR_SLOTS: usize = constants::NEAR_SLOTS as usize;

/// Number of indices in a buffer.
pub(super) fn index_count(indices: &wgpu::Buffer) -> u32 {
    (indices.size() / size_of::<u16>() as u64) as u32
}

/// Layout of the bind group of a draw list.
pub(super) fn list_layout(factory: &PassFactory) -> wgpu::BindGroupLayout {
    factory.layout("plant list", &[storage(0), storage(1), uniform(2), texture(3)])
}

/// Fraction of the plants that are drawn at a distance; same as `density` in WGSL.
pub(super) fn density(distance_m: f32, full_m: f32) -> f32 {
    (full_m / distance_m.max(LEAST_DENSITY_DISTANCE_M)).powi(2).min(1.0)
}

pub(super) fn storage_compute(binding: u32) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry { visibility: wgpu::ShaderStages::COMPUTE, ..storage(binding) }
}
