//! The listed blades from far to near (000 §5.4): a compute pass gives each a key, which they are sorted by, and two indirect draws follow that order.

use crate::render::gpu::Gpu;
use crate::render::pipeline::{Maker, bind_as, storage, storage_rw, uniform};
use crate::render::shaders;
use crate::render::sort::{Sort, Sorter};
use crate::render::uniforms::Ordering;
use shared::lod::Section;
use wgpu::BufferUsages;

/// Cells along the side of a grid that the sequences made beforehand tell apart; twin of `CELLS` in `order.wgsl`.
const CELLS: u32 = 64;
/// Words of `Spans`: all blades; first and number of all but the fine ones, and of those; place of the first of one segment.
const SPANS: u64 = 6;
/// Words of the arguments: of a dispatch, padded to five, and of two draws.
const DISPATCH_WORDS: usize = 4;

/// How the keys are found, and by how many bytes of them blades are sorted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Keys {
    /// The distance of the root in 15 bits, and a bit for fine blades, which come last.
    Distance,
    /// 11 bits for the offset of the grid, 12 for the place in its sequence, and that bit.
    MadeBeforehand,
}

/// What orders the blades of a scene.
pub(in crate::render) struct Ordered {
    keys: Keys,
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

impl Ordered {
    /// Orders at most `capacities` fine blades and others of `blades`, as many as `drawn` says; `indices` are those of an instance of others and of fine
    /// ones.
    pub(super) fn new(
        maker: &Maker<'_>,
        keys: Keys,
        [blades, drawn]: [&wgpu::Buffer; 2],
        capacities: [u32; 2],
        indices: [u32; 2],
        grid_m: f32,
    ) -> Self {
        let gpu = maker.gpu;
        let sorter = Sorter::new(gpu);
        let spans = gpu.empty_buffer("spans", SPANS * 4, BufferUsages::STORAGE | BufferUsages::COPY_SRC);
        let all = capacities.iter().sum();
        let digits = match keys {
            Keys::Distance => 2,
            Keys::MadeBeforehand => 3,
        };
        let sort = Sort::new(gpu, &sorter, &spans, 0, all, digits);
        let [others, fine] = indices.map(|count| [count, 0, 0, 0, 0]);
        let words = [&[0, 1, 1, 0][..], &others, &fine].concat();
        let arguments = gpu.buffer("blades in order", bytemuck::cast_slice(&words), BufferUsages::STORAGE | BufferUsages::INDIRECT);
        let ordering = gpu.empty_buffer("ordering", size_of::<Ordering>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let places = match keys {
            Keys::Distance => vec![0],
            Keys::MadeBeforehand => sequences(),
        };
        let places = gpu.buffer("sequences", bytemuck::cast_slice(&places), BufferUsages::STORAGE);
        let read = |binding| wgpu::BindGroupLayoutEntry { visibility: wgpu::ShaderStages::COMPUTE, ..storage(binding) };
        let span_layout = maker.layout("spans", &[uniform(0), read(1), read(2), storage_rw(3), storage_rw(4)]);
        let key_layout = maker.layout("keys", &[uniform(0), read(1), read(2), storage_rw(3), storage_rw(5), read(6)]);
        let group = |layout, buffers: &[_]| bind_as(gpu, "order", layout, buffers);
        let module = maker.shader("order", shaders::ORDER, &[]);
        Self {
            span: maker.compute("span_blades", &module, "span_blades", &span_layout),
            key: maker.compute("key_blades", &module, "key_blades", &key_layout),
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

    /// Where each span begins and how long it is.
    pub(in crate::render) fn spans(&self) -> &wgpu::Buffer {
        &self.spans
    }

    /// The pairs in order.
    pub(in crate::render) fn pairs(&self) -> &wgpu::Buffer {
        self.sort.sorted()
    }

    /// Says where the camera is, which is in grid `home`.
    pub(super) fn prepare(&self, gpu: &Gpu, home: [i32; 2]) {
        let ordering = Ordering {
            lists: [self.capacities[0], self.capacities[1], u32::from(self.keys == Keys::MadeBeforehand), 0],
            home: [home[0], home[1], 0, 0],
            shape: [self.grid_m, 0.0, 0.0, 0.0],
        };
        gpu.queue.write_buffer(&self.ordering, 0, bytemuck::bytes_of(&ordering));
    }

    /// Orders what has been listed.
    pub(super) fn run(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(&self.span);
        pass.set_bind_group(1, &self.span_group, &[]);
        pass.dispatch_workgroups(1, 1, 1);
        pass.set_pipeline(&self.key);
        pass.set_bind_group(1, &self.key_group, &[]);
        pass.dispatch_workgroups_indirect(&self.arguments, 0);
        self.sort.run(&self.sorter, pass);
    }

    /// Draws the others, and then the fine blades.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, span: usize) {
        pass.draw_indexed_indirect(&self.arguments, ((DISPATCH_WORDS + 5 * span) * 4) as u64);
    }
}

/// For each of 3 × 3 sections about the camera's grid, by row, the place in its sequence of each cell of a grid.
fn sequences() -> Vec<u32> {
    let mut places = vec![0; (9 * CELLS * CELLS) as usize];
    for section in 0..9 {
        let cells = Section::of([section % 3 - 1, section / 3 - 1]).sequence(CELLS);
        for (place, [column, row]) in (0..).zip(cells) {
            places[(section as u32 * CELLS * CELLS + row * CELLS + column) as usize] = place;
        }
    }
    places
}
