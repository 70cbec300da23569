//! Culling of single plants: compute passes list those in view, so that only these are bent.

use super::far_grids::FarGrids;
use super::layout::{CHUNK, NEAR_SLOTS, storage_compute};
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{PassFactory, bind_as, storage_rw, uniform};
use crate::render::gpu::shaders;
use crate::render::gpu::variants::OcclusionVariants;
use crate::render::inputs::depth_pyramid::{PYRAMID_BINDING, pyramid_layout};
use wgpu::BufferUsages;

/// Counters before the lists.
const COUNTS: u64 = 2;

pub(super) struct PlantCulling {
    ground: wgpu::ComputePipeline,
    /// Pipelines for near plants, and for those beyond.
    sift: OcclusionVariants<[wgpu::ComputePipeline; 2]>,
    group: wgpu::BindGroup,
    standing: wgpu::Buffer,
    workgroups: wgpu::Buffer,
}

impl PlantCulling {
    /// Passes for `places` plants per near grid.
    pub(super) fn new(factory: &PassFactory, shader: &wgpu::ShaderModule, plants: &wgpu::Buffer, grids: &FarGrids, places: u32) -> Self {
        let gpu = &factory.gpu;
        let most = u64::from(places) * NEAR_SLOTS as u64 + u64::from(grids.capacity) * u64::from(CHUNK);
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let standing = gpu.empty_buffer("standing plants", 4 * (COUNTS + most), usage | BufferUsages::COPY_SRC);
        let workgroups = gpu.empty_buffer("workgroups of plants", 24, usage | BufferUsages::INDIRECT);
        let grounds = gpu.empty_buffer("ground below near plants", 4 * NEAR_SLOTS as u64 * u64::from(places), BufferUsages::STORAGE);
        let layout =
            factory.layout("sift", &[uniform(0), storage_compute(4), storage_rw(8), storage_rw(9), storage_rw(10), pyramid_layout()]);
        let buffers =
            [(0, plants), (4, grids.chunks()), (8, &standing), (9, &workgroups), (10, &grounds), (PYRAMID_BINDING, &factory.pyramid)];
        let group = bind_as(gpu, "sift", &layout, &buffers);
        let ground = factory.compute("find_ground", shader, "find_ground", &layout);
        Self { ground, sift: sift_pipelines(factory.clone(), layout), group, standing, workgroups }
    }

    /// Numbers of the near and of the far plants in view, followed by both lists.
    pub(super) fn standing(&self) -> &wgpu::Buffer {
        &self.standing
    }

    /// Workgroups of the near and of the far plants, for indirect dispatches.
    pub(super) fn workgroups(&self) -> &wgpu::Buffer {
        &self.workgroups
    }

    /// Clears the lists.
    pub(super) fn begin_batch(&self, gpu: &Gpu) {
        gpu.queue.write_buffer(&self.standing, 0, &[0; 4 * COUNTS as usize]);
        gpu.queue.write_buffer(&self.workgroups, 0, bytemuck::bytes_of(&[0_u32, 1, 1, 0, 1, 1]));
    }

    /// Computes the ground height below all plants of the near grids that moved in in this frame, with `workgroups` per grid.
    pub(super) fn find_ground(&self, pass: &mut wgpu::ComputePass<'_>, workgroups: u32) {
        pass.set_bind_group(1, &self.group, &[]);
        pass.set_pipeline(&self.ground);
        pass.dispatch_workgroups(workgroups, NEAR_SLOTS as u32, 1);
    }

    /// Creates a variant of a pipeline that no frame has needed yet. Returns false if there is none.
    pub(super) fn create_next(&self) -> bool {
        self.sift.create_next()
    }

    /// Lists the plants in view of the nine near grids, and of the chunks of far ones, whose number is read from a buffer; if `occludes`, without those that
    /// solids hide.
    pub(super) fn run(&self, pass: &mut wgpu::ComputePass<'_>, near_workgroups: u32, chunks: &wgpu::Buffer, occludes: bool) {
        let [near, far] = self.sift.with([occludes]);
        pass.set_bind_group(1, &self.group, &[]);
        if near_workgroups > 0 {
            pass.set_pipeline(near);
            pass.dispatch_workgroups(near_workgroups, NEAR_SLOTS as u32, 1);
        }
        pass.set_pipeline(far);
        pass.dispatch_workgroups_indirect(chunks, 0);
    }
}

/// Pipelines that list near plants, and those beyond.
fn sift_pipelines(factory: PassFactory, layout: wgpu::BindGroupLayout) -> OcclusionVariants<[wgpu::ComputePipeline; 2]> {
    OcclusionVariants::tested(move |constants| {
        let module = factory.shader("sift", shaders::BEND, &constants);
        ["sift_near", "sift_far"].map(|entry| factory.compute(entry, &module, entry, &layout))
    })
}
