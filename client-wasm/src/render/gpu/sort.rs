//! Stable radix sort on the GPU, of pairs of a key and a number. Their count is read from a buffer.
//!
//! Least significant digit first, eight bits at a time. Each digit reads a pair twice and writes it once (24 bytes); a tile of 1024 pairs also reads and
//! writes 6 KiB of counts. About 30 operations per pair, most of them on workgroup memory. Sorting by 16 bits moves 1.9 MB for 32 000 pairs and 60 MB for a
//! million. The serial part grows with the number of tiles / 64: 16 steps for a million pairs.

use crate::render::gpu::constants::{DIGITS, SORT_TILE};
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{bind_as, storage, storage_rw, uniform};
use crate::render::gpu::shaders;
use crate::render::gpu::uniforms::SortDigit;
use wgpu::BufferUsages;

/// Bytes of the counts of all values of a digit.
const DIGITS_BYTES: u64 = 4 * DIGITS as u64;
/// Bytes of a pair of key and number.
pub(crate) const PAIR_BYTES: u64 = 8;

/// Pipelines that all sorts share.
pub(crate) struct Sorter {
    plan: wgpu::ComputePipeline,
    count: wgpu::ComputePipeline,
    place: wgpu::ComputePipeline,
    shift: wgpu::ComputePipeline,
    plan_layout: wgpu::BindGroupLayout,
    digit_layout: wgpu::BindGroupLayout,
}

impl Sorter {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let layout = |entries: &[_]| gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("sort"), entries });
        let read = |binding| wgpu::BindGroupLayoutEntry { visibility: wgpu::ShaderStages::COMPUTE, ..storage(binding) };
        let plan_layout = layout(&[read(0), uniform(1), storage_rw(2)]);
        let digit_layout = layout(&[read(0), uniform(1), read(3), storage_rw(4), storage_rw(5)]);
        let module = gpu.shader("sort", shaders::SORT, &[]);
        let pipeline = |entry, own| {
            let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("sort"),
                bind_group_layouts: &[None, Some(own)],
                immediate_size: 0,
            });
            gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry),
                layout: Some(&layout),
                module: &module,
                entry_point: Some(entry),
                compilation_options: Default::default(),
                cache: None,
            })
        };
        Self {
            plan: pipeline("plan_tiles", &plan_layout),
            count: pipeline("count_digits", &digit_layout),
            place: pipeline("place_digits", &digit_layout),
            shift: pipeline("move_pairs", &digit_layout),
            plan_layout,
            digit_layout,
        }
    }
}

/// A list of pairs that is sorted by ascending keys.
pub(crate) struct Sort {
    pairs: [wgpu::Buffer; 2],
    tiles: wgpu::Buffer,
    plan_group: wgpu::BindGroup,
    digit_groups: Vec<wgpu::BindGroup>,
}

impl Sort {
    /// Sorts by the lowest `digits` bytes of the keys. The number of pairs is element `counter` of `counters`, at most `capacity`.
    pub(crate) fn new(gpu: &Gpu, sorter: &Sorter, counters: &wgpu::Buffer, counter: u32, capacity: u32, digits: u32) -> Self {
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        let pairs = [(); 2].map(|()| gpu.empty_buffer("pairs", u64::from(capacity.max(1)) * PAIR_BYTES, usage));
        let places = gpu.empty_buffer("sort places", (u64::from(capacity.div_ceil(SORT_TILE)) + 1) * DIGITS_BYTES, BufferUsages::STORAGE);
        let tiles = gpu.empty_buffer("sort tiles", 12, BufferUsages::STORAGE | BufferUsages::INDIRECT);
        let shapes: Vec<wgpu::Buffer> = (0..digits)
            .map(|digit| SortDigit { lowest_bit: 8 * digit, counter, limit: capacity, _pad: [0; 4] })
            .map(|shape| gpu.buffer("sort digit", bytemuck::bytes_of(&shape), BufferUsages::UNIFORM))
            .collect();
        let grouped = |layout, buffers: &[_]| bind_as(gpu, "sort", layout, buffers);
        let plan_group = grouped(&sorter.plan_layout, &[(0, counters), (1, &shapes[0]), (2, &tiles)]);
        let digit_groups = shapes
            .iter()
            .enumerate()
            .map(|(digit, shape)| {
                let [unsorted, sorted] = [&pairs[digit % 2], &pairs[(digit + 1) % 2]];
                grouped(&sorter.digit_layout, &[(0, counters), (1, shape), (3, unsorted), (4, sorted), (5, &places)])
            })
            .collect();
        Self { pairs, tiles, plan_group, digit_groups }
    }

    /// Buffer of the pairs before sorting.
    pub(crate) fn unsorted(&self) -> &wgpu::Buffer {
        &self.pairs[0]
    }

    /// Buffer of the pairs after sorting.
    pub(crate) fn sorted(&self) -> &wgpu::Buffer {
        &self.pairs[self.digit_groups.len() % 2]
    }

    /// Runs the sort.
    pub(crate) fn run(&self, sorter: &Sorter, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(&sorter.plan);
        pass.set_bind_group(1, &self.plan_group, &[]);
        pass.dispatch_workgroups(1, 1, 1);
        for group in &self.digit_groups {
            pass.set_bind_group(1, group, &[]);
            pass.set_pipeline(&sorter.count);
            pass.dispatch_workgroups_indirect(&self.tiles, 0);
            pass.set_pipeline(&sorter.place);
            pass.dispatch_workgroups(DIGITS, 1, 1);
            pass.set_pipeline(&sorter.shift);
            pass.dispatch_workgroups_indirect(&self.tiles, 0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::gpu::readback::read;

    /// Pairs with these keys and consecutive numbers, sorted by the GPU and by the CPU.
    fn both(gpu: &Gpu, keys: &[u32], counted: u32, capacity: u32, digits: u32) -> [Vec<[u32; 2]>; 2] {
        let sorter = Sorter::new(gpu);
        // The first counter belongs to another list.
        let counters = gpu.buffer("counters", bytemuck::cast_slice(&[7, counted]), BufferUsages::STORAGE);
        let sort = Sort::new(gpu, &sorter, &counters, 1, capacity, digits);
        let mut pairs: Vec<[u32; 2]> = (0..).zip(keys).map(|(number, &key)| [key, number]).collect();
        gpu.queue.write_buffer(sort.unsorted(), 0, bytemuck::cast_slice(&pairs));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        sort.run(&sorter, &mut encoder.begin_compute_pass(&Default::default()));
        gpu.queue.submit([encoder.finish()]);
        let count = counted.min(capacity) as usize;
        let found: Vec<[u32; 2]> = bytemuck::pod_collect_to_vec(&read(gpu, sort.sorted()));
        pairs.truncate(count);
        pairs.sort_by_key(|&[key, _]| key & (u32::MAX >> (32 - 8 * digits)));
        [found[..count].to_vec(), pairs]
    }

    fn random(count: u32, limit: u32) -> Vec<u32> {
        (0..count).map(|n| prairie_core::hash::hash3([n, 3, 5])[0] % limit).collect()
    }

    #[test]
    fn lists_of_any_length_are_sorted_stably() {
        let gpu = Gpu::headless().expect("a Vulkan adapter");
        for count in [0, 1, 2, 255, 256, 257, 1023, 1024, 1025, 9999, 130_001] {
            for (keys, digits) in
                [(random(count, 65_536), 2), (random(count, 5), 2), (vec![77; count as usize], 1), (random(count, u32::MAX), 4)]
            {
                let [found, wanted] = both(&gpu, &keys, count, count.max(1), digits);
                assert!(found == wanted, "{count} pairs by {digits} digits");
            }
        }
    }

    #[test]
    fn bytes_above_the_digits_are_ignored() {
        let gpu = Gpu::headless().expect("a Vulkan adapter");
        let [found, wanted] = both(&gpu, &random(3000, u32::MAX), 3000, 3000, 3);
        assert_eq!(found, wanted);
    }

    #[test]
    fn a_counter_beyond_the_list_sorts_the_whole_list() {
        let gpu = Gpu::headless().expect("a Vulkan adapter");
        let [found, wanted] = both(&gpu, &random(5000, 65_536), 70_000, 5000, 2);
        assert_eq!(found, wanted);
    }
}
