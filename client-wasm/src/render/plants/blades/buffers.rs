//! Buffers of the blades, and the bind groups made of them.

use super::layout::{BLADE_BYTES, HEADS, LISTS, NEAR_SLOTS, STRIPS, SWAY_BYTES, index_count, list_layout};
use super::strips::{disc_indices, head_indices, square_indices, strip_indices};
use crate::render::gpu::constants::{COARSE_LIST, FAR_HEAD_LIST, FINE_LIST, HEAD_LIST, SINGLE_LIST};
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{PassFactory, bind, bind_at};
use crate::render::gpu::uniforms::{Plants, StripList};
use crate::render::plants::force_field::CameraForceField;
use prairie_core::scene::FlowerShape;
use wgpu::BufferUsages;

pub(super) struct BladeBuffers {
    /// Uniforms of the compute passes.
    pub(super) plants: wgpu::Buffer,
    /// Postures of the near plants.
    pub(super) sways: wgpu::Buffer,
    /// Number of the frame in which each near plant was last moved.
    moved: wgpu::Buffer,
    /// Plants to draw, list by list.
    pub(super) drawn: wgpu::Buffer,
    /// Lengths of the lists.
    pub(super) counters: wgpu::Buffer,
}

impl BladeBuffers {
    /// Buffers for `places` plants per near grid, and lists of these capacities.
    pub(super) fn new(gpu: &Gpu, places: u32, capacities: [u32; 3]) -> Self {
        let read_back = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        let near = u64::from(places) * NEAR_SLOTS as u64;
        let drawn = u64::from(capacities.iter().sum::<u32>());
        Self {
            plants: gpu.empty_buffer("plants", size_of::<Plants>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST),
            sways: gpu.empty_buffer("sways", near * SWAY_BYTES, read_back),
            moved: gpu.empty_buffer("moved", near * 4, BufferUsages::STORAGE),
            drawn: gpu.empty_buffer("drawn plants", drawn * BLADE_BYTES, read_back),
            counters: gpu.empty_buffer("counters", 4 * LISTS as u64, read_back | BufferUsages::COPY_DST),
        }
    }

    /// Bind group of the bend passes.
    pub(super) fn compute_group(
        &self,
        gpu: &Gpu,
        layout: &wgpu::BindGroupLayout,
        [chunks, draws, standing]: [&wgpu::Buffer; 3],
        forces: &CameraForceField,
    ) -> wgpu::BindGroup {
        let buffers = [&self.plants, &self.sways, &self.drawn, &self.counters, chunks, draws, standing, &self.moved];
        let own = (0..).zip(buffers.map(|buffer| buffer.as_entire_binding()));
        bind_at(gpu, "bend", layout, own.chain(forces.resources()))
    }

    /// Bind group of each list. Blades of one segment fill the space of the coarse ones from its end, far heads that of the near ones.
    pub(super) fn list_groups(
        &self,
        factory: &PassFactory,
        [fine, others, heads]: [u32; 3],
        segments: [u32; 2],
        [shapes, flowers]: [&wgpu::TextureView; 2],
    ) -> [wgpu::BindGroup; LISTS] {
        let layout = list_layout(factory);
        let lists = [
            strip_list(0, fine, segments[0], FINE_LIST, 1),
            strip_list(fine, others, segments[1], COARSE_LIST, 1),
            strip_list(fine + others - 1, others, 1, SINGLE_LIST, -1),
            strip_list(fine + others, heads, 0, HEAD_LIST, 1),
            strip_list(fine + others + heads - 1, heads, 0, FAR_HEAD_LIST, -1),
        ];
        lists.map(|list| {
            let texture = if HEADS.contains(&(list.number as usize)) { flowers } else { shapes };
            let list = factory.gpu.buffer("list", bytemuck::bytes_of(&list), BufferUsages::UNIFORM);
            let [drawn, counters, list] = [&self.drawn, &self.counters, &list].map(|buffer| buffer.as_entire_binding());
            bind(&factory.gpu, "plant list", &layout, &[drawn, counters, list, wgpu::BindingResource::TextureView(texture)])
        })
    }
}

/// Index buffers of the instances of each list.
pub(super) struct InstanceIndices {
    /// Strips of blades with broad tips, and of pointed ones.
    pub(super) strips: [[wgpu::Buffer; STRIPS]; 2],
    pub(super) heads: [wgpu::Buffer; 2],
}

impl InstanceIndices {
    /// Index buffers for fine and coarse blades with these numbers of segments, and for near flowers of a shape.
    pub(super) fn new(gpu: &Gpu, [fine, coarse]: [u32; 2], flowers: FlowerShape) -> Self {
        let buffer = |list: Vec<u16>| gpu.buffer("plant", bytemuck::cast_slice(&list), BufferUsages::INDEX);
        let strips = |are_pointed| [fine, coarse, 1].map(|segments| buffer(strip_indices(segments, are_pointed)));
        let near_heads = match flowers {
            FlowerShape::Modelled => head_indices(),
            FlowerShape::Textured => square_indices(),
        };
        Self { strips: [false, true].map(strips), heads: [near_heads, disc_indices()].map(buffer) }
    }

    /// Indirect draws of all lists, without instances, for blades with broad tips.
    pub(super) fn draws(&self, gpu: &Gpu) -> wgpu::Buffer {
        let words: Vec<u32> = self.strips[0].iter().chain(&self.heads).flat_map(|list| [index_count(list), 0, 0, 0, 0]).collect();
        let usage = BufferUsages::STORAGE | BufferUsages::INDIRECT | BufferUsages::COPY_DST;
        gpu.buffer("plant draws", bytemuck::cast_slice(&words), usage)
    }
}

/// A draw list that begins at index `first`, of blades with `segments` segments.
fn strip_list(first: u32, capacity: u32, segments: u32, number: u32, step: i32) -> StripList {
    StripList { first, capacity, segments, number, step, _pad: [0; 12] }
}
