//! Sort of the listed blades from far to near (Zhang, section 5.4): a compute pass computes a key for each, and two indirect draws follow the sorted order.

use crate::render::gpu::constants::{DISPATCH_WORDS, DRAW_WORDS, ORDER_CELLS};
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{PassFactory, bind_as, storage, storage_rw, uniform};
use crate::render::gpu::shaders;
use crate::render::gpu::sort::{Sort, Sorter};
use crate::render::gpu::uniforms::Ordering;
use prairie_core::lod::GridSection;
use wgpu::BufferUsages;

/// Words of `Spans` in WGSL.
const SPANS: u64 = 6;

/// How the sort keys are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SortKeys {
    /// Distance of the root in 15 bits, and a bit for fine blades, which come last; sorted by 2 bytes.
    Distance,
    /// 11 bits for the offset of the grid, 12 for the position in its sequence, and the same bit; sorted by 3 bytes.
    Precomputed,
}

/// Sorts the blades of a scene.
pub(crate) struct BladeSort {
    keys: SortKeys,
    sorter: Sorter,
    sort: Sort,
    span: wgpu::ComputePipeline,
    key: wgpu::ComputePipeline,
    span_group: wgpu::BindGroup,
    key_group: wgpu::BindGroup,
    ordering: wgpu::Buffer,
    spans: wgpu::Buffer,
    arguments: wgpu::Buffer,
    capacities: [u32; 2],
    grid_m: f32,
}

impl BladeSort {
    /// Sorts at most `capacities` fine and other `blades`; their numbers are read from `drawn`. `indices` are the indices of an instance of other and
    /// of fine blades.
    pub(super) fn new(
        factory: &PassFactory,
        keys: SortKeys,
        [blades, drawn]: [&wgpu::Buffer; 2],
        capacities: [u32; 2],
        indices: [u32; 2],
        grid_m: f32,
    ) -> Self {
        let gpu = &factory.gpu;
        let sorter = Sorter::new(gpu);
        let spans = gpu.empty_buffer("spans", SPANS * 4, BufferUsages::STORAGE | BufferUsages::COPY_SRC);
        let all = capacities.iter().sum();
        let digits = match keys {
            SortKeys::Distance => 2,
            SortKeys::Precomputed => 3,
        };
        let sort = Sort::new(gpu, &sorter, &spans, 0, all, digits);
        let [others, fine] = indices.map(|count| [count, 0, 0, 0, 0]);
        let words = [&[0, 1, 1, 0][..], &others, &fine].concat();
        let arguments = gpu.buffer("blades in order", bytemuck::cast_slice(&words), BufferUsages::STORAGE | BufferUsages::INDIRECT);
        let ordering = gpu.empty_buffer("ordering", size_of::<Ordering>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let places = match keys {
            SortKeys::Distance => vec![0],
            SortKeys::Precomputed => sequences(),
        };
        let places = gpu.buffer("sequences", bytemuck::cast_slice(&places), BufferUsages::STORAGE);
        let read = |binding| wgpu::BindGroupLayoutEntry { visibility: wgpu::ShaderStages::COMPUTE, ..storage(binding) };
        let span_layout = factory.layout("spans", &[uniform(0), read(1), read(2), storage_rw(3), storage_rw(4)]);
        let key_layout = factory.layout("keys", &[uniform(0), read(1), read(2), storage_rw(3), storage_rw(5), read(6)]);
        let group = |layout, buffers: &[_]| bind_as(gpu, "order", layout, buffers);
        let module = factory.shader("order", shaders::ORDER, &[]);
        Self {
            span: factory.compute("span_blades", &module, "span_blades", &span_layout),
            key: factory.compute("key_blades", &module, "key_blades", &key_layout),
            span_group: group(&span_layout, &[(0, &ordering), (1, blades), (2, drawn), (3, &spans), (4, &arguments)]),
            key_group: group(&key_layout, &[(0, &ordering), (1, blades), (2, drawn), (3, &spans), (5, sort.unsorted()), (6, &places)]),
            keys,
            sorter,
            sort,
            ordering,
            spans,
            arguments,
            capacities,
            grid_m,
        }
    }

    /// Beginning and length of each span.
    pub(crate) fn spans(&self) -> &wgpu::Buffer {
        &self.spans
    }

    /// The sorted pairs.
    pub(crate) fn pairs(&self) -> &wgpu::Buffer {
        self.sort.sorted()
    }

    /// Sets the grid of the camera.
    pub(super) fn prepare(&self, gpu: &Gpu, home: [i32; 2]) {
        let ordering = Ordering {
            camera_grid: home,
            fine_capacity: self.capacities[0],
            other_capacity: self.capacities[1],
            is_precomputed: u32::from(self.keys == SortKeys::Precomputed),
            grid_m: self.grid_m,
            _pad: [0; 8],
        };
        gpu.queue.write_buffer(&self.ordering, 0, bytemuck::bytes_of(&ordering));
    }

    /// Sorts the listed blades.
    pub(super) fn run(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(&self.span);
        pass.set_bind_group(1, &self.span_group, &[]);
        pass.dispatch_workgroups(1, 1, 1);
        pass.set_pipeline(&self.key);
        pass.set_bind_group(1, &self.key_group, &[]);
        pass.dispatch_workgroups_indirect(&self.arguments, 0);
        self.sort.run(&self.sorter, pass);
    }

    /// Draws a span: 0 for the other, 1 for the fine blades.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, span: usize) {
        pass.draw_indexed_indirect(&self.arguments, ((DISPATCH_WORDS as usize + DRAW_WORDS as usize * span) * 4) as u64);
    }
}

/// For each of 3 × 3 sections around the camera's grid, row by row, the position of each cell of a grid in the sequence of the section.
fn sequences() -> Vec<u32> {
    let mut places = vec![0; (9 * ORDER_CELLS * ORDER_CELLS) as usize];
    for section in 0..9 {
        let cells = GridSection::of([section % 3 - 1, section / 3 - 1]).sequence(ORDER_CELLS);
        for (place, [column, row]) in (0..).zip(cells) {
            places[(section as u32 * ORDER_CELLS * ORDER_CELLS + row * ORDER_CELLS + column) as usize] = place;
        }
    }
    places
}
