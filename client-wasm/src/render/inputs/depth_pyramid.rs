//! Depth pyramid: the farthest depth of the solids drawn so far, by cells of the picture (Greene et al. 1993).

use crate::render::gpu::constants::{PYRAMID_CELL_PX, PYRAMID_LEVELS, PYRAMID_SIDE, WORKGROUP_SIZE};
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{PassFactory, bind_at, storage_rw};
use crate::render::gpu::shaders;
use wgpu::{BindingType, BufferUsages, ShaderStages, TextureSampleType, TextureViewDimension};

/// Binding of the pyramid in group 1 of the passes that test it.
pub(crate) const PYRAMID_BINDING: u32 = 40;

/// Buffer of a pyramid of any picture, as in `depth_pyramid.wgsl`.
pub(crate) fn pyramid_buffer(gpu: &Gpu) -> wgpu::Buffer {
    let cells: u64 = (0..=PYRAMID_LEVELS).map(|level| u64::from(PYRAMID_SIDE >> level).pow(2)).sum();
    gpu.empty_buffer("depth pyramid", 4 * cells, BufferUsages::STORAGE)
}

/// Layout entry of the pyramid for the passes that test it.
pub(crate) fn pyramid_layout() -> wgpu::BindGroupLayoutEntry {
    let ty =
        BindingType::Buffer { ty: wgpu::BufferBindingType::Storage { read_only: true }, has_dynamic_offset: false, min_binding_size: None };
    wgpu::BindGroupLayoutEntry { binding: PYRAMID_BINDING, visibility: ShaderStages::COMPUTE, ty, count: None }
}

/// The passes that reduce the depth buffer to the pyramid.
pub(crate) struct DepthPyramid {
    finest: wgpu::ComputePipeline,
    coarser: wgpu::ComputePipeline,
    finest_layout: wgpu::BindGroupLayout,
    finest_group: wgpu::BindGroup,
    coarser_group: wgpu::BindGroup,
    pyramid: wgpu::Buffer,
    /// Binding of the depth buffer, which depends on its samples.
    depth_binding: u32,
    workgroups: u32,
}

impl DepthPyramid {
    /// Passes for a depth buffer with the samples of the factory. A pyramid of the nearest instead of the farthest depths hides too much; tests need it.
    pub(crate) fn new(factory: &PassFactory, depth: &wgpu::TextureView, keeps_nearest: bool) -> Self {
        let gpu = &factory.gpu;
        let multisampled = factory.samples > 1;
        let (entry, depth_binding) = if multisampled { ("reduce_samples", 1) } else { ("reduce_depths", 0) };
        let module = factory.shader("depth pyramid", shaders::DEPTH_REDUCTION, &[("keeps_nearest", keeps_nearest)]);
        let sampled = wgpu::BindGroupLayoutEntry {
            binding: depth_binding,
            visibility: ShaderStages::COMPUTE,
            ty: BindingType::Texture { sample_type: TextureSampleType::Depth, view_dimension: TextureViewDimension::D2, multisampled },
            count: None,
        };
        let finest_layout = factory.layout(entry, &[sampled, storage_rw(2)]);
        let coarser_layout = factory.layout("reduce_levels", &[storage_rw(2)]);
        let pyramid = &factory.pyramid;
        Self {
            finest: factory.compute(entry, &module, entry, &finest_layout),
            coarser: factory.compute("reduce_levels", &module, "reduce_levels", &coarser_layout),
            finest_group: finest_group(gpu, &finest_layout, depth_binding, depth, pyramid),
            coarser_group: bind_at(gpu, "reduce_levels", &coarser_layout, [(2, pyramid.as_entire_binding())]),
            finest_layout,
            pyramid: pyramid.clone(),
            depth_binding,
            workgroups: workgroups(depth),
        }
    }

    /// Sets another depth buffer with as many samples.
    pub(crate) fn set_depth(&mut self, gpu: &Gpu, depth: &wgpu::TextureView) {
        self.finest_group = finest_group(gpu, &self.finest_layout, self.depth_binding, depth, &self.pyramid);
        self.workgroups = workgroups(depth);
    }

    /// Reduces the depth buffer as it is drawn so far.
    pub(crate) fn reduce(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(&self.finest);
        pass.set_bind_group(1, &self.finest_group, &[]);
        pass.dispatch_workgroups(self.workgroups, 1, 1);
        pass.set_pipeline(&self.coarser);
        pass.set_bind_group(1, &self.coarser_group, &[]);
        pass.dispatch_workgroups(1, 1, 1);
    }
}

fn finest_group(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    depth_binding: u32,
    depth: &wgpu::TextureView,
    pyramid: &wgpu::Buffer,
) -> wgpu::BindGroup {
    let resources = [(depth_binding, wgpu::BindingResource::TextureView(depth)), (2, pyramid.as_entire_binding())];
    bind_at(gpu, "reduce depths", layout, resources)
}

/// Workgroups of the cells of the finest level.
fn workgroups(depth: &wgpu::TextureView) -> u32 {
    let size_px = [depth.texture().width(), depth.texture().height()];
    let cell_px = cell_px(size_px);
    size_px.map(|px| px.div_ceil(cell_px)).iter().product::<u32>().div_ceil(WORKGROUP_SIZE)
}

/// Side of a cell of the finest level (px). Twin of `pyramid_cell_px` in depth_pyramid.wgsl.
fn cell_px([width, height]: [u32; 2]) -> u32 {
    width.max(height).div_ceil(PYRAMID_SIDE).max(PYRAMID_CELL_PX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cells_of_any_picture_fit_into_the_pyramid() {
        for side_px in [1, 3, 96, 255, 256, 1023, 1024, 1025, 1920, 3840, 8192, 16_384] {
            for size_px in [[side_px, 54], [54, side_px], [side_px; 2]] {
                let cell_px = cell_px(size_px);
                assert!(cell_px >= PYRAMID_CELL_PX && size_px.iter().all(|px| px.div_ceil(cell_px) <= PYRAMID_SIDE), "{size_px:?}");
            }
        }
    }
}
