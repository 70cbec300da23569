//! Clumps of far plants (Zhang, section 4.1). Their number and length depend on how many grids away from the camera they are.

use crate::render::gpu::constants::{CLUMP_FADE_SPREAD_M, CLUMP_PLANTS, CLUMPS, WORKGROUP_SIZE};
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{PassFactory, bind_at, storage, storage_rw, uniform};
use crate::render::gpu::shaders;
use crate::render::gpu::uniforms::ClumpList;
use crate::render::inputs::frustum::Frustum;
use crate::render::inputs::random::random3;
use crate::render::options::render_options::BlendOrder;
use crate::render::plants::blades::grid_is_seen;
use crate::render::plants::clump_pipelines::{Cell, ClumpBuffers, ClumpPipelines};
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
const POSE_BYTES: u64 = 64;
/// Maximum number of segments of a clump.
const SEGMENT_LIMIT: usize = 6;
/// Maximum number of joints of all plants that clumps join: 16 MiB, which every device can bind.
const JOINT_LIMIT: usize = 1 << 20;
const _: () = assert!(CLUMP_LIMIT * CLUMP_PLANTS as usize <= JOINT_LIMIT, "there is a joint for every plant of the clumps");
/// Least distance from which wind is raised (m), where clumps begin at the camera.
const LEAST_RAISED_M: f32 = 1.0;
/// Rings of grids that get the clumps of the nearest ring, as plants thin out there.
const DENSE_GRIDS: u32 = 2;

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Clump {
    axis_m: [f32; 2],
    length_m: f32,
    random: f32,
}

/// Distances between which clumps are drawn (m), and the motion of their plants.
pub(crate) struct ClumpRange {
    pub(crate) from_m: f32,
    /// Distance beyond which clumps have one segment.
    pub(crate) several_m: f32,
    pub(crate) to_m: f32,
    /// Mean wind over the ground (m/s, X and Z) if the deviation of the wind from it grows in proportion to distance beyond `from_m`; `None` if it does not.
    pub(crate) raised_over_m_per_s: Option<[f32; 2]>,
}

/// A grid within the range of the clumps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClumpGrid {
    /// Position in the plane of grids (x, z).
    pub(crate) grid: [i32; 2],
    /// Plants along one side of its clumps, l' of Zhang, Eq. (8).
    pub(crate) plants: u32,
    /// Whether it may be in view; otherwise it is culled.
    pub(crate) is_seen: bool,
}

pub(crate) struct Billboards {
    pub(crate) pipelines: PerBlendOrder<ClumpPipelines>,
    place: wgpu::ComputePipeline,
    bend_plants: wgpu::ComputePipeline,
    pose_group: wgpu::BindGroup,
    pub(crate) buffers: ClumpBuffers,
    tufts: wgpu::TextureView,
    /// Index buffers of instances whose rectangles have 1, 2, … rows.
    indices: [wgpu::Buffer; SEGMENT_LIMIT],
    grids: Vec<ClumpGrid>,
    count: u32,
    /// Instances whose clumps have several segments, and their maximum number of segments.
    several: u32,
    segments: usize,
}

impl Billboards {
    pub(crate) fn new(factory: &PassFactory, forces: &CameraForceField) -> Self {
        let gpu = &factory.gpu;
        let own_layout = [storage(0), uniform(1), storage_rw(4), storage_rw(8)];
        let layout = factory.layout("clump poses", &[&own_layout[..], &CameraForceField::layout()].concat());
        let module = factory.shader("billboards", shaders::BILLBOARDS, &[]);
        let [place, bend_plants] = ["place", "bend_plants"].map(|entry| factory.compute(entry, &module, entry, &layout));
        let kept = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        let buffers = ClumpBuffers {
            clumps: gpu.empty_buffer("clumps", (CLUMP_LIMIT * size_of::<Clump>()) as u64, kept | BufferUsages::COPY_DST),
            list: gpu.empty_buffer(
                "clump list",
                size_of::<ClumpList>() as u64,
                BufferUsages::UNIFORM | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
            ),
            poses: gpu.empty_buffer("poses", CLUMP_LIMIT as u64 * POSE_BYTES, kept),
            joints: gpu.empty_buffer("joints", JOINT_LIMIT as u64 * 16, kept),
        };
        let ClumpBuffers { clumps, list, poses, joints } = &buffers;
        let own = [(0, clumps), (1, list), (4, poses), (8, joints)].map(|(binding, buffer)| (binding, buffer.as_entire_binding()));
        let pose_group = bind_at(gpu, "clump poses", &layout, own.into_iter().chain(forces.resources()));
        let tufts = gpu.texture("tufts", wgpu::TextureFormat::Rgba8Unorm, TUFT_PX, &tufts());
        let tufts = tufts.create_view(&Default::default());
        let indices = std::array::from_fn(|i| gpu.buffer("clump", bytemuck::cast_slice(&clump_indices(i as u16 + 1)), BufferUsages::INDEX));
        let pipelines = ClumpPipelines::new(factory, BlendOrder::default(), CLUMP_LIMIT as u32, &buffers, &tufts);
        Self {
            pipelines: PerBlendOrder::new(BlendOrder::default(), pipelines),
            place,
            bend_plants,
            pose_group,
            buffers,
            tufts,
            indices,
            grids: Vec::new(),
            count: 0,
            several: 0,
            segments: 1,
        }
    }

    /// Sets the blend order of the following frames.
    pub(crate) fn set_order(&mut self, factory: &PassFactory, order: BlendOrder) {
        let (buffers, tufts) = (&self.buffers, &self.tufts);
        self.pipelines.set(order, || ClumpPipelines::new(factory, order, CLUMP_LIMIT as u32, buffers, tufts));
    }

    /// Lists the clumps in view, nearest grids first.
    pub(crate) fn prepare(&mut self, gpu: &Gpu, decoded: &DecodedScene, eye_m: Vec3, frustum: &Frustum, within: &ClumpRange) {
        let plants = &decoded.scene().plants;
        let grid_m = plants.grid_m;
        let home = [eye_m.x, eye_m.z].map(|m| (m / grid_m).floor() as i32);
        let reach = (within.to_m / grid_m).ceil() as i32;
        let several_rings = (within.several_m / grid_m) as i32;
        let mut listed = Listed::default();
        let mut several = 0;
        self.grids.clear();
        'rings: for ring in 0..=reach {
            if ring <= several_rings {
                several = listed.clumps.len();
            }
            for [dx, dz] in ring_of(ring) {
                let grid = [home[0] + dx, home[1] + dz];
                let centre = grid.map(|n| (n as f32 + 0.5) * grid_m);
                let distance_m = (centre[0] - eye_m.x).hypot(centre[1] - eye_m.z);
                if distance_m + grid_m < within.from_m {
                    continue;
                }
                let away = (ring as u32).saturating_sub(DENSE_GRIDS).max(1);
                let is_seen = grid_is_seen(decoded, grid, grid_m, frustum);
                self.grids.push(ClumpGrid { grid, plants: billboard_plants(away), is_seen });
                if is_seen && !listed.add_grid(decoded, eye_m, within, [dx, dz], away) {
                    break 'rings;
                }
            }
        }
        self.segments = decoded.scene().kinds().iter().map(|grass| grass.segments as usize).max().unwrap_or(1).clamp(1, SEGMENT_LIMIT);
        self.count = listed.clumps.len() as u32;
        self.several = several.min(self.several_limit()).div_ceil(CLUMPS as usize) as u32;
        let several = self.count.min(self.several * CLUMPS);
        gpu.queue.write_buffer(&self.buffers.clumps, 0, bytemuck::cast_slice(&listed.clumps));
        self.pipelines.get_mut().prepare(gpu, &listed.cells, several as usize);
        // Every clump beyond the last ring with several segments is at least this far away.
        let straight_m = ((several_rings - 1) as f32 * grid_m).max(1.0);
        let list = ClumpList {
            count: self.count,
            several_instances: self.several,
            several_segments: self.segments as u32,
            several,
            straightens_m: 0.5 * straight_m,
            straight_m,
            mean_wind_m_per_s: within.raised_over_m_per_s.unwrap_or_default(),
            raised_from_m: if within.raised_over_m_per_s.is_some() { within.from_m.max(LEAST_RAISED_M) } else { f32::MAX },
            _pad: [0; 12],
        };
        gpu.queue.write_buffer(&self.buffers.list, 0, bytemuck::bytes_of(&list));
    }

    /// Clumps that may have several segments, so that there is room for the joints of all.
    fn several_limit(&self) -> usize {
        let spare = JOINT_LIMIT / CLUMP_PLANTS as usize - self.count as usize;
        (spare / (self.segments - 1).max(1)).saturating_sub(CLUMPS as usize)
    }

    /// Grids within the range of the clumps in the newest frame, nearest first.
    pub(crate) fn grids(&self) -> &[ClumpGrid] {
        &self.grids
    }

    /// Clumps in the frame.
    pub(crate) fn count(&self) -> u32 {
        self.count
    }

    /// Computes the pose of each listed clump and bends the plants that it joins, and sorts the clumps if needed.
    pub(crate) fn bend(&self, pass: &mut wgpu::ComputePass<'_>) {
        if self.count > 0 {
            pass.set_bind_group(1, &self.pose_group, &[]);
            pass.set_pipeline(&self.place);
            pass.dispatch_workgroups(self.count.div_ceil(WORKGROUP_SIZE), 1, 1);
            pass.set_pipeline(&self.bend_plants);
            pass.dispatch_workgroups((self.count * CLUMP_PLANTS).div_ceil(WORKGROUP_SIZE), 1, 1);
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

/// Clumps of a frame, and their positions in the lattices of their grids.
#[derive(Default)]
struct Listed {
    clumps: Vec<Clump>,
    cells: Vec<Cell>,
}

impl Listed {
    /// Adds the clumps of the grid at an offset from the camera's that counts as `away` grids away. Returns false if there is no room for more.
    fn add_grid(&mut self, decoded: &DecodedScene, eye_m: Vec3, within: &ClumpRange, offset: [i32; 2], away: u32) -> bool {
        let plants = &decoded.scene().plants;
        let grid_m = plants.grid_m;
        let grid = [(eye_m.x / grid_m).floor() as i32 + offset[0], (eye_m.z / grid_m).floor() as i32 + offset[1]];
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
                self.clumps.push(Clump { axis_m, length_m: spacing_m * 0.5 * overlap, random: random[2] });
                self.cells.push(Cell { away: offset, per_side, at: [i, j] });
                if self.clumps.len() == CLUMP_LIMIT {
                    return false;
                }
            }
        }
        true
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
