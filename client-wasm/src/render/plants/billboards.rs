//! Clumps of far plants (Zhang, section 4.1). Their number and length depend on how many grids away from the camera they are.

use crate::render::gpu::constants::{CLUMP_FADE_SPREAD_M, CLUMP_SEGMENT_LIMIT, CLUMPS, WORKGROUP_SIZE};
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{PassFactory, bind_at, storage, storage_rw, uniform};
use crate::render::gpu::shaders;
use crate::render::gpu::uniforms::ClumpList;
use crate::render::inputs::frustum::Frustum;
use crate::render::inputs::random::random3;
use crate::render::options::render_options::BlendOrder;
use crate::render::plants::blades::grid_is_seen;
use crate::render::plants::clump_pipelines::{Cell, ClumpPipelines};
use crate::render::plants::clump_texture::{TUFT_PX, tufts};
use crate::render::plants::force_field::CameraForceField;
use crate::render::plants::per_blend_order::PerBlendOrder;
use crate::state::DecodedScene;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use prairie_core::lod::{billboard_plants, billboards_per_side};
use std::ops::Range;
use wgpu::BufferUsages;

/// Maximum number of clumps in a frame.
const CLUMP_LIMIT: usize = 32_768;
/// Bytes of `ClumpPose` in `billboards.wgsl`.
const POSE_BYTES: u64 = 160;
/// Maximum number of segments of a plant.
const SEGMENT_LIMIT: usize = CLUMP_SEGMENT_LIMIT as usize;
/// Rings of grids that get the clumps of the nearest ring, as plants thin out there.
const DENSE_GRIDS: u32 = 2;

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Clump {
    axis_m: [f32; 2],
    length_m: f32,
    random: f32,
}

/// Distances between which clumps are drawn (m).
pub(crate) struct ClumpRange {
    pub(crate) from_m: f32,
    /// Distance beyond which clumps have one segment.
    pub(crate) several_m: f32,
    pub(crate) to_m: f32,
}

pub(crate) struct Billboards {
    pub(crate) pipelines: PerBlendOrder<ClumpPipelines>,
    place: wgpu::ComputePipeline,
    place_group: wgpu::BindGroup,
    pub(crate) clumps: wgpu::Buffer,
    list: wgpu::Buffer,
    pub(crate) poses: wgpu::Buffer,
    tufts: wgpu::TextureView,
    /// Index buffers of instances whose rectangles have 1, 2, … rows.
    indices: [wgpu::Buffer; SEGMENT_LIMIT],
    pub(crate) count: u32,
    /// Instances whose clumps have several segments, and their maximum number of segments.
    several: u32,
    segments: usize,
}

impl Billboards {
    pub(crate) fn new(factory: &PassFactory, forces: &CameraForceField) -> Self {
        let gpu = &factory.gpu;
        let place_layout =
            factory.layout("billboard places", &[&[storage(0), uniform(1), storage_rw(4)][..], &CameraForceField::layout()].concat());
        let module = factory.shader("billboards", shaders::BILLBOARDS, &[]);
        let place = factory.compute("place", &module, "place", &place_layout);
        let size = (CLUMP_LIMIT * size_of::<Clump>()) as u64;
        let clumps = gpu.empty_buffer("clumps", size, BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC);
        let list = gpu.empty_buffer("clump list", size_of::<ClumpList>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let tufts = gpu.texture("tufts", wgpu::TextureFormat::Rgba8Unorm, TUFT_PX, &tufts());
        let tufts = tufts.create_view(&Default::default());
        let poses = gpu.empty_buffer("poses", (CLUMP_LIMIT as u64) * POSE_BYTES, BufferUsages::STORAGE | BufferUsages::COPY_SRC);
        let place_group = {
            let own = [(0, &clumps), (1, &list), (4, &poses)].map(|(binding, buffer)| (binding, buffer.as_entire_binding()));
            bind_at(gpu, "billboard places", &place_layout, own.into_iter().chain(forces.resources()))
        };
        let indices = std::array::from_fn(|i| gpu.buffer("clump", bytemuck::cast_slice(&clump_indices(i as u16 + 1)), BufferUsages::INDEX));
        let pipelines = ClumpPipelines::new(factory, BlendOrder::default(), CLUMP_LIMIT as u32, [&clumps, &list, &poses], &tufts);
        Self {
            pipelines: PerBlendOrder::new(BlendOrder::default(), pipelines),
            place,
            place_group,
            clumps,
            list,
            poses,
            tufts,
            indices,
            count: 0,
            several: 0,
            segments: 1,
        }
    }

    /// Sets the blend order of the following frames.
    pub(crate) fn set_order(&mut self, factory: &PassFactory, order: BlendOrder) {
        let lists = [&self.clumps, &self.list, &self.poses];
        self.pipelines.set(order, || ClumpPipelines::new(factory, order, CLUMP_LIMIT as u32, lists, &self.tufts));
    }

    /// Lists the clumps in view, nearest grids first.
    pub(crate) fn prepare(&mut self, gpu: &Gpu, decoded: &DecodedScene, eye_m: Vec3, frustum: &Frustum, within: ClumpRange) {
        let plants = &decoded.scene().plants;
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
                if distance_m + grid_m < within.from_m || !grid_is_seen(decoded, grid, grid_m, frustum) {
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
                        if is_nearer(decoded, axis_m, eye_m, within.from_m - CLUMP_FADE_SPREAD_M) {
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
        self.several = several.div_ceil(CLUMPS as usize) as u32;
        let several = self.count.min(self.several * CLUMPS);
        self.pipelines.get_mut().prepare(gpu, &cells, several as usize);
        self.segments = decoded.scene().kinds().iter().map(|grass| grass.segments as usize).max().unwrap_or(1).clamp(1, SEGMENT_LIMIT);
        // Every clump beyond the last ring with several segments is at least this far away.
        let straight_m = ((several_rings - 1) as f32 * grid_m).max(1.0);
        let list = ClumpList {
            count: self.count,
            several_instances: self.several,
            several_segments: self.segments as u32,
            several,
            straightens_m: 0.5 * straight_m,
            straight_m,
            _pad: [0; 8],
        };
        gpu.queue.write_buffer(&self.list, 0, bytemuck::bytes_of(&list));
    }

    /// Clumps in the frame.
    pub(crate) fn count(&self) -> u32 {
        self.count
    }

    /// Computes the pose of each listed clump, and sorts them if needed.
    pub(crate) fn bend(&self, pass: &mut wgpu::ComputePass<'_>) {
        if self.count > 0 {
            pass.set_pipeline(&self.place);
            pass.set_bind_group(1, &self.place_group, &[]);
            pass.dispatch_workgroups(self.count.div_ceil(WORKGROUP_SIZE), 1, 1);
            self.pipelines.get().run(pass, self.count);
        }
    }

    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipelines.get().pipeline);
        pass.set_bind_group(1, &self.pipelines.get().group, &[]);
        for (rows, range) in self.instances() {
            pass.set_index_buffer(self.indices[rows - 1].slice(..), wgpu::IndexFormat::Uint16);
            pass.draw_indexed(0..CLUMPS * 36 * rows as u32, 0, range);
        }
    }

    /// Rows and ranges of the instances in drawing order: near ones first, or last if clumps are drawn far to near.
    fn instances(&self) -> [(usize, Range<u32>); 2] {
        if self.pipelines.get().is_in_order() {
            let single = (self.count - self.count.min(self.several * CLUMPS)).div_ceil(CLUMPS);
            return [(1, 0..single), (self.segments, single..single + self.several)];
        }
        [(self.segments, 0..self.several), (1, self.several..self.count.div_ceil(CLUMPS))]
    }
}

/// Whether a position on the ground is nearer to the eye than `limit_m`.
fn is_nearer(decoded: &DecodedScene, [x, z]: [f32; 2], eye_m: Vec3, limit_m: f32) -> bool {
    let is_near = |y: f32| eye_m.distance_squared(Vec3::new(x, y, z)) < limit_m * limit_m;
    limit_m > 0.0 && is_near(eye_m.y) && is_near(decoded.heights().height_m(x, z))
}

/// Triangles of the clumps of an instance, six rectangles each with this number of rows.
fn clump_indices(rows: u16) -> Vec<u16> {
    let corners = 2 * (rows + 1);
    let firsts = (0..CLUMPS as u16 * 6).flat_map(|rectangle| (0..rows).map(move |row| rectangle * corners + 2 * row));
    firsts.flat_map(|a| [a, a + 1, a + 2, a + 2, a + 1, a + 3]).collect()
}

/// Offsets of the grids at a Chebyshev distance of `ring`.
fn ring_of(ring: i32) -> impl Iterator<Item = [i32; 2]> {
    (-ring..=ring).flat_map(move |dz| {
        let step = if dz.abs() == ring { 1 } else { (2 * ring).max(1) };
        (-ring..=ring).step_by(step as usize).map(move |dx| [dx, dz])
    })
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
}
