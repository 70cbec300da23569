//! Which plants of the grids about the camera stand in view: compute passes list them, so that only those are bent.

use super::grids::Grids;
use super::{CHUNK, storage_compute};
use crate::render::gpu::Gpu;
use crate::render::pipeline::{Maker, storage_rw, uniform};
use wgpu::BufferUsages;

/// Numbers before the lists: how many each of them has.
const COUNTS: u64 = 2;

pub(super) struct Sift {
    ground: wgpu::ComputePipeline,
    near: wgpu::ComputePipeline,
    far: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    standing: wgpu::Buffer,
    workgroups: wgpu::Buffer,
}

impl Sift {
    /// `places` plants fit in a near grid; `shader` has what the passes are made of.
    pub(super) fn new(maker: &Maker<'_>, shader: &wgpu::ShaderModule, plants: &wgpu::Buffer, grids: &Grids, places: u32) -> Self {
        let gpu = maker.gpu;
        let most = u64::from(places) * 9 + u64::from(grids.capacity) * u64::from(CHUNK);
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let standing = gpu.empty_buffer("standing plants", 4 * (COUNTS + most), usage | BufferUsages::COPY_SRC);
        let workgroups = gpu.empty_buffer("workgroups of plants", 24, usage | BufferUsages::INDIRECT);
        let grounds = gpu.empty_buffer("ground below near plants", 4 * 9 * u64::from(places), BufferUsages::STORAGE);
        let layout = maker.layout("sift", &[uniform(0), storage_compute(4), storage_rw(8), storage_rw(9), storage_rw(10)]);
        let entries = [(0, plants), (4, grids.chunks()), (8, &standing), (9, &workgroups), (10, &grounds)]
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() });
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("sift"), layout: &layout, entries: &entries });
        let compute = |entry| maker.compute(entry, shader, entry, &layout);
        Self { ground: compute("find_ground"), near: compute("sift_near"), far: compute("sift_far"), group, standing, workgroups }
    }

    /// How many plants stand in view, near ones and others, and the lists of both.
    pub(super) fn standing(&self) -> &wgpu::Buffer {
        &self.standing
    }

    /// Workgroups of the near plants and of the others, each for an indirect dispatch.
    pub(super) fn workgroups(&self) -> &wgpu::Buffer {
        &self.workgroups
    }

    /// Empties the lists.
    pub(super) fn begin_turn(&self, gpu: &Gpu) {
        gpu.queue.write_buffer(&self.standing, 0, &[0; 4 * COUNTS as usize]);
        gpu.queue.write_buffer(&self.workgroups, 0, bytemuck::bytes_of(&[0_u32, 1, 1, 0, 1, 1]));
    }

    /// Finds the land below all plants, so many workgroups of them a grid, of the near grids that have moved in in this frame.
    pub(super) fn find_ground(&self, pass: &mut wgpu::ComputePass<'_>, workgroups: u32) {
        pass.set_bind_group(1, &self.group, &[]);
        pass.set_pipeline(&self.ground);
        pass.dispatch_workgroups(workgroups, 9, 1);
    }

    /// Lists what stands in view of the nine near grids and of as many chunks of others as an indirect dispatch says.
    pub(super) fn run(&self, pass: &mut wgpu::ComputePass<'_>, near_workgroups: u32, chunks: &wgpu::Buffer) {
        pass.set_bind_group(1, &self.group, &[]);
        if near_workgroups > 0 {
            pass.set_pipeline(&self.near);
            pass.dispatch_workgroups(near_workgroups, 9, 1);
        }
        pass.set_pipeline(&self.far);
        pass.dispatch_workgroups_indirect(chunks, 0);
    }
}
