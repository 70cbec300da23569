//! Pipelines that draw clumps in a blend order: sorted on the GPU, or grids far to near and clumps in the sequences of their sections
//! (Zhang, section 5.4.2).

use crate::render::gpu::constants::WORKGROUP_SIZE;
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{DrawDescriptor, PassFactory, bind_as, storage, storage_rw, texture, uniform};
use crate::render::gpu::shaders;
use crate::render::gpu::sort::{PAIR_BYTES, Sort, Sorter};
use crate::render::options::render_options::BlendOrder;
use crate::render::plants::blending::blend_pipeline;
use prairie_core::lod::GridSection;
use std::cmp::Reverse;
use std::collections::HashMap;
use wgpu::BufferUsages;

/// Position of a clump in the lattice of its grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell {
    /// Offset from the grid of the camera, X and Z (grids).
    pub(crate) away: [i32; 2],
    /// Clumps along a side of the grid.
    pub(crate) per_side: u32,
    /// Column and row.
    pub(crate) at: [u32; 2],
}

/// Clumps of a frame on the GPU.
pub(crate) struct ClumpBuffers {
    /// `Clump` of each.
    pub(crate) clumps: wgpu::Buffer,
    /// Uniforms of the list.
    pub(crate) list: wgpu::Buffer,
    /// `ClumpPose` of each.
    pub(crate) poses: wgpu::Buffer,
    /// Joints of the plants that each joins.
    pub(crate) joints: wgpu::Buffer,
}

/// Resources of one blend order.
pub(crate) struct ClumpPipelines {
    pub(crate) pipeline: wgpu::RenderPipeline,
    pub(crate) group: wgpu::BindGroup,
    sequence: DrawSequence,
}

enum DrawSequence {
    AsListed,
    Sorted(Box<Sorted>),
    Precomputed { pairs: wgpu::Buffer, places: HashMap<([i32; 2], u32), Vec<u32>> },
}

struct Sorted {
    sorter: Sorter,
    sort: Sort,
    count: wgpu::Buffer,
    key: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
}

impl ClumpPipelines {
    /// Creates pipelines for at most `limit` clumps.
    pub(crate) fn new(
        factory: &PassFactory,
        order: BlendOrder,
        limit: u32,
        ClumpBuffers { clumps, list, poses, joints }: &ClumpBuffers,
        tufts: &wgpu::TextureView,
    ) -> Self {
        let gpu = &factory.gpu;
        let module = factory.shader("billboards", shaders::BILLBOARDS, &[]);
        let sequence = match order {
            BlendOrder::Cut | BlendOrder::Coverage | BlendOrder::Weighted => DrawSequence::AsListed,
            BlendOrder::Sorted => DrawSequence::Sorted(Box::new(Sorted::new(factory, limit, &module, clumps, list))),
            BlendOrder::Precomputed => {
                let usage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
                let pairs = gpu.empty_buffer("clumps in order", u64::from(limit) * PAIR_BYTES, usage);
                DrawSequence::Precomputed { pairs, places: HashMap::new() }
            }
        };
        let pairs = match &sequence {
            DrawSequence::AsListed => None,
            DrawSequence::Sorted(sorted) => Some(sorted.sort.sorted()),
            DrawSequence::Precomputed { pairs, .. } => Some(pairs),
        };
        let mut layout = vec![storage(0), uniform(1), texture(2), storage(3), storage(7)];
        let mut entries = vec![(0, clumps), (1, list), (3, poses), (7, joints)];
        if let Some(pairs) = pairs {
            layout.push(storage(6));
            entries.push((6, pairs));
        }
        let layout = factory.layout("billboards", &layout);
        let mut entries: Vec<_> =
            entries.iter().map(|&(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() }).collect();
        entries.push(wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::TextureView(tufts) });
        let descriptor = wgpu::BindGroupDescriptor { label: Some("billboards"), layout: &layout, entries: &entries };
        let vertex = if pairs.is_some() { "vs_in_order" } else { "vs" };
        let fragment = match order {
            BlendOrder::Cut => "fs",
            BlendOrder::Weighted => "fs_weighted",
            BlendOrder::Coverage | BlendOrder::Sorted | BlendOrder::Precomputed => "fs_soft",
        };
        let draw = DrawDescriptor { label: "billboards", vertex, fragment: Some(fragment), ..DrawDescriptor::default() };
        Self {
            pipeline: blend_pipeline(factory, &module, Some(&layout), &draw, order),
            group: gpu.device.create_bind_group(&descriptor),
            sequence,
        }
    }

    /// Whether clumps are drawn far to near.
    pub(crate) fn is_in_order(&self) -> bool {
        !matches!(self.sequence, DrawSequence::AsListed)
    }

    /// Sets the cells of the clumps of a frame. The first `several` have several segments and are drawn last.
    pub(crate) fn prepare(&mut self, gpu: &Gpu, cells: &[Cell], several: usize) {
        match &mut self.sequence {
            DrawSequence::AsListed => {}
            DrawSequence::Sorted(sorted) => gpu.queue.write_buffer(&sorted.count, 0, bytemuck::bytes_of(&(cells.len() as u32))),
            DrawSequence::Precomputed { pairs, places } => {
                let mut order: Vec<_> = (0..cells.len()).map(|number| (key(places, cells[number], number < several), number)).collect();
                order.sort_unstable();
                let order: Vec<[u32; 2]> = order.into_iter().map(|(_, number)| [0, number as u32]).collect();
                gpu.queue.write_buffer(pairs, 0, bytemuck::cast_slice(&order));
            }
        }
    }

    /// Sorts the listed clumps, if the GPU does so.
    pub(crate) fn run(&self, pass: &mut wgpu::ComputePass<'_>, count: u32) {
        if let DrawSequence::Sorted(sorted) = &self.sequence {
            pass.set_pipeline(&sorted.key);
            pass.set_bind_group(1, &sorted.group, &[]);
            pass.dispatch_workgroups(count.div_ceil(WORKGROUP_SIZE), 1, 1);
            sorted.sort.run(&sorted.sorter, pass);
        }
    }
}

impl Sorted {
    fn new(factory: &PassFactory, limit: u32, module: &wgpu::ShaderModule, clumps: &wgpu::Buffer, list: &wgpu::Buffer) -> Self {
        let gpu = &factory.gpu;
        let sorter = Sorter::new(gpu);
        let count = gpu.empty_buffer("clump count", 4, BufferUsages::STORAGE | BufferUsages::COPY_DST);
        let sort = Sort::new(gpu, &sorter, &count, 0, limit, 2);
        let layout = factory.layout("clump keys", &[storage(0), uniform(1), storage_rw(5)]);
        let group = bind_as(gpu, "clump keys", &layout, &[(0, clumps), (1, list), (5, sort.unsorted())]);
        let key = factory.compute("key_clumps", module, "key_clumps", &layout);
        Self { sorter, sort, count, key, group }
    }
}

/// Sort key of a clump: those of one segment first, then grids far to near by the square of their offset, then the position in the sequence of the section.
fn key(places: &mut HashMap<([i32; 2], u32), Vec<u32>>, cell: Cell, is_several: bool) -> (bool, Reverse<i32>, u32) {
    let Cell { away: [x, z], per_side, at: [column, row] } = cell;
    let section = [x.signum(), z.signum()];
    let of_section = places.entry((section, per_side)).or_insert_with(|| {
        let mut places = vec![0; (per_side * per_side) as usize];
        for (place, [column, row]) in (0..).zip(GridSection::of(section).sequence(per_side)) {
            places[(row * per_side + column) as usize] = place;
        }
        places
    });
    (is_several, Reverse(x * x + z * z), of_section[(row * per_side + column) as usize])
}
