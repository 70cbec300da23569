//! Clumps of far plants (000 section 4.1): how many and how long follows from the grids between them and the camera.

use super::blades::grid_is_seen;
use super::cull::Frustum;
use super::gpu::Gpu;
use super::paint;
use super::pipeline::{Draw, Maker, bind, storage, storage_rw, texture, uniform};
use super::shaders;
use crate::state::Land;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use shared::hash::hash3;
use shared::lod::{billboard_plants, billboards_per_side};
use wgpu::BufferUsages;

/// Clumps in one instance; twin of the constant in `billboards.wgsl`.
const CHUNK: u32 = 32;
/// Most clumps in a frame.
const CLUMP_LIMIT: usize = 32_768;
/// Bytes of a clump's pose, `Stand` in `billboards.wgsl`.
const STAND_BYTES: u64 = 64;
/// Grids up to this many away get the clumps of the nearest ring, as plants thin out there.
const DENSE_GRIDS: u32 = 2;

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Clump {
    axis_m: [f32; 2],
    length_m: f32,
    random: f32,
}

pub(super) struct Billboards {
    pipeline: wgpu::RenderPipeline,
    place: wgpu::ComputePipeline,
    place_group: wgpu::BindGroup,
    clumps: wgpu::Buffer,
    list: wgpu::Buffer,
    group: wgpu::BindGroup,
    indices: wgpu::Buffer,
    count: u32,
}

impl Billboards {
    pub(super) fn new(maker: &Maker<'_>) -> Self {
        let gpu = maker.gpu;
        let layout = maker.layout("billboards", &[storage(0), uniform(1), texture(2), storage(3)]);
        let place_layout = maker.layout("billboard places", &[storage(0), uniform(1), storage_rw(4)]);
        let draw =
            Draw { label: "billboards", vertex: "vs", fragment: Some("fs"), buffers: &[], depth_write: true, cull: None, blend: None };
        let module = gpu.shader("billboards", shaders::BILLBOARDS);
        let pipeline = maker.draw(&module, Some(&layout), &draw);
        let place = maker.compute("place", &module, "place", &place_layout);
        let size = (CLUMP_LIMIT * size_of::<Clump>()) as u64;
        let clumps = gpu.empty_buffer("clumps", size, BufferUsages::STORAGE | BufferUsages::COPY_DST);
        let list = gpu.empty_buffer("clump list", 16, BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let tufts = gpu.texture("tufts", wgpu::TextureFormat::Rgba8Unorm, paint::TUFT_PX, &paint::tufts());
        let tufts = tufts.create_view(&Default::default());
        let stands = gpu.empty_buffer("stands", (CLUMP_LIMIT as u64) * STAND_BYTES, BufferUsages::STORAGE);
        let texture = wgpu::BindingResource::TextureView(&tufts);
        let [clump_list, count, placed] = [&clumps, &list, &stands].map(|buffer| buffer.as_entire_binding());
        let group = bind(gpu, "billboards", &layout, &[clump_list.clone(), count.clone(), texture, placed.clone()]);
        let place_entries =
            [(0, clump_list), (1, count), (4, placed)].map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource });
        let place_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("billboard places"),
            layout: &place_layout,
            entries: &place_entries,
        });
        let rectangles = (0..CHUNK as u16 * 6).map(|i| i * 4);
        let indices: Vec<u16> = rectangles.flat_map(|a| [a, a + 1, a + 2, a + 2, a + 1, a + 3]).collect();
        let indices = gpu.buffer("clump", bytemuck::cast_slice(&indices), BufferUsages::INDEX);
        Self { pipeline, place, place_group, clumps, list, group, indices, count: 0 }
    }

    /// Lists the clumps in view between `from_m` and `to_m`, nearest grids first.
    pub(super) fn prepare(&mut self, gpu: &Gpu, land: &Land, eye_m: Vec3, frustum: &Frustum, from_m: f32, to_m: f32) {
        let plants = &land.scene().plants;
        let grid_m = plants.grid_m;
        let home = [eye_m.x, eye_m.z].map(|m| (m / grid_m).floor() as i32);
        let reach = (to_m / grid_m).ceil() as i32;
        let mut clumps = Vec::new();
        'rings: for ring in 0..=reach {
            for [dx, dz] in ring_of(ring) {
                let grid = [home[0] + dx, home[1] + dz];
                let centre = grid.map(|n| (n as f32 + 0.5) * grid_m);
                let distance_m = (centre[0] - eye_m.x).hypot(centre[1] - eye_m.z);
                if distance_m + grid_m < from_m || !grid_is_seen(land, grid, grid_m, frustum) {
                    continue;
                }
                let away = (ring as u32).saturating_sub(DENSE_GRIDS).max(1);
                let per_side = billboards_per_side(plants.plants_per_side, away);
                let spacing_m = grid_m / per_side as f32;
                let overlap = 1.25 + 0.35 * (billboard_plants(away) as f32).recip();
                for j in 0..per_side {
                    for i in 0..per_side {
                        let random = random3(grid, i + j * 256);
                        let place = |n: i32, k: u32, r: f32| n as f32 * grid_m + (k as f32 + 0.15 + 0.7 * r) * spacing_m;
                        clumps.push(Clump {
                            axis_m: [place(grid[0], i, random[0]), place(grid[1], j, random[1])],
                            length_m: spacing_m * 0.5 * overlap,
                            random: random[2],
                        });
                        if clumps.len() == CLUMP_LIMIT {
                            break 'rings;
                        }
                    }
                }
            }
        }
        self.count = clumps.len() as u32;
        gpu.queue.write_buffer(&self.clumps, 0, bytemuck::cast_slice(&clumps));
        gpu.queue.write_buffer(&self.list, 0, bytemuck::bytes_of(&[self.count, 0, 0, 0]));
    }

    /// Clumps in the frame.
    pub(super) fn count(&self) -> u32 {
        self.count
    }

    /// Finds how each listed clump stands.
    pub(super) fn bend(&self, pass: &mut wgpu::ComputePass<'_>) {
        if self.count > 0 {
            pass.set_pipeline(&self.place);
            pass.set_bind_group(1, &self.place_group, &[]);
            pass.dispatch_workgroups(self.count.div_ceil(64), 1, 1);
        }
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &self.group, &[]);
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint16);
        pass.draw_indexed(0..CHUNK * 36, 0, 0..self.count.div_ceil(CHUNK));
    }
}

/// Offsets of the grids that lie `ring` away (Chebyshev distance).
fn ring_of(ring: i32) -> impl Iterator<Item = [i32; 2]> {
    (-ring..=ring).flat_map(move |dz| {
        let step = if dz.abs() == ring { 1 } else { (2 * ring).max(1) };
        (-ring..=ring).step_by(step as usize).map(move |dx| [dx, dz])
    })
}

/// Three random numbers in 0..1 for a grid and a number; twin of `random3` in `common.wgsl`.
pub(super) fn random3(place: [i32; 2], number: u32) -> [f32; 3] {
    hash3([place[0] as u32, place[1] as u32, number]).map(|v| (v >> 8) as f32 / 16_777_216.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_cover_the_square_once() {
        let mut grids: Vec<_> = (0..=4).flat_map(ring_of).collect();
        let count = grids.len();
        grids.sort();
        grids.dedup();
        assert_eq!((grids.len(), count), (81, 81));
    }

    #[test]
    fn random_numbers_fill_their_range() {
        let mean = (0..1000).map(|n| random3([3, -7], n)[0]).sum::<f32>() / 1000.0;
        assert!((mean - 0.5).abs() < 0.05, "{mean}");
    }
}
