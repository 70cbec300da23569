//! Clumps of far plants (000 section 4.1): how many and how long follows from the grids between them and the camera.

use super::blades::grid_is_seen;
use super::clump_order::{Cell, Laid};
use super::cull::Frustum;
use super::gpu::Gpu;
use super::kept::Kept;
use super::look::Order;
use super::paint;
use super::pipeline::{Maker, bind_as, storage, storage_rw, uniform};
use super::shaders;
use crate::state::Land;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use shared::hash::hash3;
use shared::lod::{billboard_plants, billboards_per_side};
use std::ops::Range;
use wgpu::BufferUsages;

/// Clumps in one instance; twin of `CLUMPS` in `billboards.wgsl`.
const CHUNK: u32 = 32;
/// Most clumps in a frame.
const CLUMP_LIMIT: usize = 32_768;
/// Bytes of a clump's pose, `Stand` in `billboards.wgsl`.
const STAND_BYTES: u64 = 160;
/// Most segments of a plant.
const SEGMENT_LIMIT: usize = 6;
/// A clump fades in this much nearer or farther than others; twin of the spread in `billboards.wgsl`.
const FADE_SPREAD_M: f32 = 1.0;
/// Grids up to this many away get the clumps of the nearest ring, as plants thin out there.
const DENSE_GRIDS: u32 = 2;

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Clump {
    axis_m: [f32; 2],
    length_m: f32,
    random: f32,
}

/// How far from the camera clumps are drawn (m).
pub(super) struct Reach {
    pub(super) from_m: f32,
    /// From here on as one segment.
    pub(super) several_m: f32,
    pub(super) to_m: f32,
}

/// What the shaders know of a frame's clumps: `List` in `billboards.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct List {
    /// Clumps; instances whose clumps have several segments, and how many at most; those clumps.
    counts: [u32; 4],
    several_m: [f32; 4],
}

pub(super) struct Billboards {
    pub(super) laid: Kept<Laid>,
    place: wgpu::ComputePipeline,
    place_group: wgpu::BindGroup,
    clumps: wgpu::Buffer,
    list: wgpu::Buffer,
    stands: wgpu::Buffer,
    tufts: wgpu::TextureView,
    /// Of instances whose rectangles have 1, 2, ... rows.
    indices: [wgpu::Buffer; SEGMENT_LIMIT],
    count: u32,
    /// Instances whose clumps have several segments, and the most that they have.
    several: u32,
    segments: usize,
}

impl Billboards {
    pub(super) fn new(maker: &Maker<'_>) -> Self {
        let gpu = maker.gpu;
        let place_layout = maker.layout("billboard places", &[storage(0), uniform(1), storage_rw(4)]);
        let module = maker.shader("billboards", shaders::BILLBOARDS, &[]);
        let place = maker.compute("place", &module, "place", &place_layout);
        let size = (CLUMP_LIMIT * size_of::<Clump>()) as u64;
        let clumps = gpu.empty_buffer("clumps", size, BufferUsages::STORAGE | BufferUsages::COPY_DST);
        let list = gpu.empty_buffer("clump list", size_of::<List>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let tufts = gpu.texture("tufts", wgpu::TextureFormat::Rgba8Unorm, paint::TUFT_PX, &paint::tufts());
        let tufts = tufts.create_view(&Default::default());
        let stands = gpu.empty_buffer("stands", (CLUMP_LIMIT as u64) * STAND_BYTES, BufferUsages::STORAGE);
        let place_group = bind_as(gpu, "billboard places", &place_layout, &[(0, &clumps), (1, &list), (4, &stands)]);
        let indices = std::array::from_fn(|i| gpu.buffer("clump", bytemuck::cast_slice(&clump_indices(i as u16 + 1)), BufferUsages::INDEX));
        let laid = Laid::new(maker, Order::default(), CLUMP_LIMIT as u32, [&clumps, &list, &stands], &tufts);
        Self {
            laid: Kept::new(Order::default(), laid),
            place,
            place_group,
            clumps,
            list,
            stands,
            tufts,
            indices,
            count: 0,
            several: 0,
            segments: 1,
        }
    }

    /// Lays clumps in another order from now on.
    pub(super) fn set_order(&mut self, maker: &Maker<'_>, order: Order) {
        let lists = [&self.clumps, &self.list, &self.stands];
        self.laid.set(order, || Laid::new(maker, order, CLUMP_LIMIT as u32, lists, &self.tufts));
    }

    /// Lists the clumps in view, nearest grids first.
    pub(super) fn prepare(&mut self, gpu: &Gpu, land: &Land, eye_m: Vec3, frustum: &Frustum, within: Reach) {
        let plants = &land.scene().plants;
        let grid_m = plants.grid_m;
        let home = [eye_m.x, eye_m.z].map(|m| (m / grid_m).floor() as i32);
        let reach = (within.to_m / grid_m).ceil() as i32;
        let several_rings = (within.several_m / grid_m) as i32;
        let mut clumps = Vec::new();
        let mut several = 0;
        let mut cells = Vec::new();
        'rings: for ring in 0..=reach {
            if ring <= several_rings {
                several = clumps.len();
            }
            for [dx, dz] in ring_of(ring) {
                let grid = [home[0] + dx, home[1] + dz];
                let centre = grid.map(|n| (n as f32 + 0.5) * grid_m);
                let distance_m = (centre[0] - eye_m.x).hypot(centre[1] - eye_m.z);
                if distance_m + grid_m < within.from_m || !grid_is_seen(land, grid, grid_m, frustum) {
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
                        let axis_m = [place(grid[0], i, random[0]), place(grid[1], j, random[1])];
                        if is_nearer(land, axis_m, eye_m, within.from_m - FADE_SPREAD_M) {
                            continue;
                        }
                        clumps.push(Clump { axis_m, length_m: spacing_m * 0.5 * overlap, random: random[2] });
                        cells.push(Cell { away: [dx, dz], per_side, at: [i, j] });
                        if clumps.len() == CLUMP_LIMIT {
                            break 'rings;
                        }
                    }
                }
            }
        }
        self.count = clumps.len() as u32;
        gpu.queue.write_buffer(&self.clumps, 0, bytemuck::cast_slice(&clumps));
        self.several = several.div_ceil(CHUNK as usize) as u32;
        let several = self.count.min(self.several * CHUNK);
        self.laid.get_mut().prepare(gpu, &cells, several as usize);
        self.segments = land.scene().kinds().iter().map(|grass| grass.segments as usize).max().unwrap_or(1).clamp(1, SEGMENT_LIMIT);
        // Every clump beyond the last ring with several segments is at least this far away.
        let straight_m = ((several_rings - 1) as f32 * grid_m).max(1.0);
        let list =
            List { counts: [self.count, self.several, self.segments as u32, several], several_m: [0.5 * straight_m, straight_m, 0.0, 0.0] };
        gpu.queue.write_buffer(&self.list, 0, bytemuck::bytes_of(&list));
    }

    /// Clumps in the frame.
    pub(super) fn count(&self) -> u32 {
        self.count
    }

    /// Finds how each listed clump stands, and their order.
    pub(super) fn bend(&self, pass: &mut wgpu::ComputePass<'_>) {
        if self.count > 0 {
            pass.set_pipeline(&self.place);
            pass.set_bind_group(1, &self.place_group, &[]);
            pass.dispatch_workgroups(self.count.div_ceil(64), 1, 1);
            self.laid.get().run(pass, self.count);
        }
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.laid.get().pipeline);
        pass.set_bind_group(1, &self.laid.get().group, &[]);
        for (rows, range) in self.instances() {
            pass.set_index_buffer(self.indices[rows - 1].slice(..), wgpu::IndexFormat::Uint16);
            pass.draw_indexed(0..CHUNK * 36 * rows as u32, 0, range);
        }
    }

    /// Rows of the instances in the order in which they are drawn: near ones first, or last where clumps are drawn far to near.
    fn instances(&self) -> [(usize, Range<u32>); 2] {
        if self.laid.get().is_in_order() {
            let single = (self.count - self.count.min(self.several * CHUNK)).div_ceil(CHUNK);
            return [(1, 0..single), (self.segments, single..single + self.several)];
        }
        [(self.segments, 0..self.several), (1, self.several..self.count.div_ceil(CHUNK))]
    }
}

/// Whether a place on the land is nearer to the eye than `limit_m`.
fn is_nearer(land: &Land, [x, z]: [f32; 2], eye_m: Vec3, limit_m: f32) -> bool {
    let is_near = |y: f32| eye_m.distance_squared(Vec3::new(x, y, z)) < limit_m * limit_m;
    limit_m > 0.0 && is_near(eye_m.y) && is_near(land.heights().height_m(x, z))
}

/// Triangles of an instance's clumps, six rectangles each, of so many rows.
fn clump_indices(rows: u16) -> Vec<u16> {
    let corners = 2 * (rows + 1);
    let firsts = (0..CHUNK as u16 * 6).flat_map(|rectangle| (0..rows).map(move |row| rectangle * corners + 2 * row));
    firsts.flat_map(|a| [a, a + 1, a + 2, a + 2, a + 1, a + 3]).collect()
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
