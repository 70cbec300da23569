//! How clumps are laid over the picture, and in what order: sorted on the GPU, or by grids far to near and the sequences of their sections (000 §5.4.2).

use super::gpu::Gpu;
use super::look::Order;
use super::pipeline::{Draw, Maker, bind_as, storage, storage_rw, texture, uniform};
use super::shaders;
use super::sort::{PAIR_BYTES, Sort, Sorter};
use shared::lod::Section;
use std::cmp::Reverse;
use std::collections::HashMap;
use wgpu::BufferUsages;

/// Where a clump stands in the lattice of its grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    /// Grids from the camera's, X and Z.
    pub(super) away: [i32; 2],
    /// Clumps along the grid's side.
    pub(super) per_side: u32,
    /// Column and row.
    pub(super) at: [u32; 2],
}

/// What one order needs.
pub(super) struct Laid {
    pub(super) pipeline: wgpu::RenderPipeline,
    pub(super) group: wgpu::BindGroup,
    way: Way,
}

enum Way {
    AsListed,
    Sorted(Box<Sorted>),
    MadeBeforehand { pairs: wgpu::Buffer, places: HashMap<([i32; 2], u32), Vec<u32>> },
}

struct Sorted {
    sorter: Sorter,
    sort: Sort,
    count: wgpu::Buffer,
    key: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
}

impl Laid {
    /// Lays at most `limit` clumps of a list that stand as `stands` says.
    pub(super) fn new(
        maker: &Maker<'_>,
        order: Order,
        limit: u32,
        [clumps, list, stands]: [&wgpu::Buffer; 3],
        tufts: &wgpu::TextureView,
    ) -> Self {
        let gpu = maker.gpu;
        let module = maker.shader("billboards", shaders::BILLBOARDS, &[]);
        let way = match order {
            Order::Cut | Order::Coverage | Order::Weighted => Way::AsListed,
            Order::Sorted => Way::Sorted(Box::new(Sorted::new(maker, limit, &module, clumps, list))),
            Order::Precomputed => {
                let usage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
                let pairs = gpu.empty_buffer("clumps in order", u64::from(limit) * PAIR_BYTES, usage);
                Way::MadeBeforehand { pairs, places: HashMap::new() }
            }
        };
        let pairs = match &way {
            Way::AsListed => None,
            Way::Sorted(sorted) => Some(sorted.sort.sorted()),
            Way::MadeBeforehand { pairs, .. } => Some(pairs),
        };
        let mut layout = vec![storage(0), uniform(1), texture(2), storage(3)];
        let mut entries = vec![(0, clumps), (1, list), (3, stands)];
        if let Some(pairs) = pairs {
            layout.push(storage(6));
            entries.push((6, pairs));
        }
        let layout = maker.layout("billboards", &layout);
        let mut entries: Vec<_> =
            entries.iter().map(|&(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() }).collect();
        entries.push(wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::TextureView(tufts) });
        let descriptor = wgpu::BindGroupDescriptor { label: Some("billboards"), layout: &layout, entries: &entries };
        let vertex = if pairs.is_some() { "vs_in_order" } else { "vs" };
        let fragment = match order {
            Order::Cut => "fs",
            Order::Weighted => "fs_weighted",
            Order::Coverage | Order::Sorted | Order::Precomputed => "fs_soft",
        };
        let draw = Draw { label: "billboards", vertex, fragment: Some(fragment), ..Draw::default() };
        Self { pipeline: maker.draw_in_order(&module, Some(&layout), &draw, order), group: gpu.device.create_bind_group(&descriptor), way }
    }

    /// Whether clumps are drawn far to near.
    pub(super) fn is_in_order(&self) -> bool {
        !matches!(self.way, Way::AsListed)
    }

    /// Takes the cells of a frame's clumps, of which the first `several` have several segments and are drawn last.
    pub(super) fn prepare(&mut self, gpu: &Gpu, cells: &[Cell], several: usize) {
        match &mut self.way {
            Way::AsListed => {}
            Way::Sorted(sorted) => gpu.queue.write_buffer(&sorted.count, 0, bytemuck::bytes_of(&(cells.len() as u32))),
            Way::MadeBeforehand { pairs, places } => {
                let mut order: Vec<_> = (0..cells.len()).map(|number| (key(places, cells[number], number < several), number)).collect();
                order.sort_unstable();
                let order: Vec<[u32; 2]> = order.into_iter().map(|(_, number)| [0, number as u32]).collect();
                gpu.queue.write_buffer(pairs, 0, bytemuck::cast_slice(&order));
            }
        }
    }

    /// Orders what has been listed, where that is up to the GPU.
    pub(super) fn run(&self, pass: &mut wgpu::ComputePass<'_>, count: u32) {
        if let Way::Sorted(sorted) = &self.way {
            pass.set_pipeline(&sorted.key);
            pass.set_bind_group(1, &sorted.group, &[]);
            pass.dispatch_workgroups(count.div_ceil(64), 1, 1);
            sorted.sort.run(&sorted.sorter, pass);
        }
    }
}

impl Sorted {
    fn new(maker: &Maker<'_>, limit: u32, module: &wgpu::ShaderModule, clumps: &wgpu::Buffer, list: &wgpu::Buffer) -> Self {
        let gpu = maker.gpu;
        let sorter = Sorter::new(gpu);
        let count = gpu.empty_buffer("clump count", 4, BufferUsages::STORAGE | BufferUsages::COPY_DST);
        let sort = Sort::new(gpu, &sorter, &count, 0, limit, 2);
        let layout = maker.layout("clump keys", &[storage(0), uniform(1), storage_rw(5)]);
        let group = bind_as(gpu, "clump keys", &layout, &[(0, clumps), (1, list), (5, sort.unsorted())]);
        let key = maker.compute("key_clumps", module, "key_clumps", &layout);
        Self { sorter, sort, count, key, group }
    }
}

/// What clumps are ordered by: those of one segment first, grids far to near by the square of their offset, then the place in the section's sequence.
fn key(places: &mut HashMap<([i32; 2], u32), Vec<u32>>, cell: Cell, is_several: bool) -> (bool, Reverse<i32>, u32) {
    let Cell { away: [x, z], per_side, at: [column, row] } = cell;
    let section = [x.signum(), z.signum()];
    let of_section = places.entry((section, per_side)).or_insert_with(|| {
        let mut places = vec![0; (per_side * per_side) as usize];
        for (place, [column, row]) in (0..).zip(Section::of(section).sequence(per_side)) {
            places[(row * per_side + column) as usize] = place;
        }
        places
    });
    (is_several, Reverse(x * x + z * z), of_section[(row * per_side + column) as usize])
}
