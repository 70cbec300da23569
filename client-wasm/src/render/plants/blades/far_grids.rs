//! Far grids: a compute pass lists the grids beyond the simulated ones that have plants in view, in chunks of 64 plants, so that the CPU time does not grow
//! with their number (Zhang, section 5.3).

use super::layout::{BATCH_LIMIT, CHUNK, density};
use crate::render::gpu::constants::TUFT_REACH_M;
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{PassFactory, bind_at, sampled, storage_rw, uniform};
use crate::render::gpu::shaders;
use crate::render::gpu::uniforms::Squares;
use crate::render::gpu::variants::OcclusionVariants;
use crate::render::inputs::depth_pyramid::{PYRAMID_BINDING, pyramid_layout};
use crate::render::inputs::frustum::Frustum;
use crate::render::inputs::lowest_land::LowestLand;
use crate::render::inputs::viewpoint::Viewpoint;
use crate::render::land_and_sky::terrain_quadtree::hills_m;
use crate::render::options::detail::Detail;
use crate::render::options::quality::Quality;
use crate::state::DecodedScene;
use glam::Vec3;
use std::ops::Range;
use wgpu::{BindingResource, BufferUsages, TextureSampleType, TextureViewDimension};

/// Simulated grids on each side of the camera's, which are not listed.
const NEAR_GRIDS: i32 = 1;

pub(super) struct FarGrids {
    list: OcclusionVariants<wgpu::ComputePipeline>,
    group: wgpu::BindGroup,
    squares: wgpu::Buffer,
    chunks: wgpu::Buffer,
    workgroups: wgpu::Buffer,
    /// State of each grid of the square.
    states: wgpu::Buffer,
    grid_m: f32,
    /// Maximum distance of a part of a plant from its root (m).
    pub(super) beyond_m: f32,
    /// Maximum number of listed chunks.
    pub(super) capacity: u32,
    /// Grids that are listed in one batch.
    grids_per_batch: u32,
    frame: Squares,
}

impl FarGrids {
    /// Pass for `places` plants per grid, listed at once or in batches.
    pub(super) fn new(factory: &PassFactory, decoded: &DecodedScene, quality: Quality, places: u32, by_batches: bool) -> Self {
        let gpu = &factory.gpu;
        let detail = &quality.detail().on(&decoded.scene().plants);
        let grid_m = decoded.scene().plants.grid_m;
        let side = side(detail, grid_m);
        let grids_per_batch = if by_batches { (BATCH_LIMIT / places.max(1)).max(1) } else { side * side };
        let capacity = chunk_limit(detail, grid_m, places, grids_per_batch);
        let layout = factory.layout(
            "grids",
            &[
                uniform(0),
                storage_rw(1),
                storage_rw(2),
                sampled(3, TextureSampleType::Float { filterable: false }, TextureViewDimension::D2),
                storage_rw(4),
                pyramid_layout(),
            ],
        );
        let squares = gpu.empty_buffer("squares", size_of::<Squares>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let chunks = gpu.empty_buffer("chunks", u64::from(capacity) * 16, BufferUsages::STORAGE | BufferUsages::COPY_SRC);
        let states = gpu.empty_buffer("grid states", u64::from(side * side) * 4, BufferUsages::STORAGE);
        let usage = BufferUsages::STORAGE | BufferUsages::INDIRECT | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        let workgroups = gpu.buffer("workgroups", bytemuck::bytes_of(&[0_u32, 1, 1]), usage);
        let lowest = LowestLand::new(decoded, grid_m);
        let lowest_cell_m = lowest.cell_m;
        let lowest = lowest.texture(gpu);
        let [own, listed, counted, found] = [&squares, &chunks, &workgroups, &states].map(|buffer| buffer.as_entire_binding());
        let resources = (0..).zip([own, listed, counted, BindingResource::TextureView(&lowest), found]);
        let group = bind_at(gpu, "grids", &layout, resources.chain([(PYRAMID_BINDING, factory.pyramid.as_entire_binding())]));
        let list = list_pipelines(factory.clone(), layout);
        let beyond_m = beyond_m(decoded);
        let frame = Squares { lowest_cell_m, thinnest_px: quality.min_blade_px(), ..bytemuck::Zeroable::zeroed() };
        Self { list, group, squares, chunks, workgroups, states, grid_m, beyond_m, capacity, grids_per_batch, frame }
    }

    /// Listed chunks.
    pub(super) fn chunks(&self) -> &wgpu::Buffer {
        &self.chunks
    }

    /// Creates a variant of a pipeline that no frame has needed yet. Returns false if there is none.
    pub(super) fn create_next(&self) -> bool {
        self.list.create_next()
    }

    /// Number of listed chunks, for an indirect dispatch.
    pub(super) fn workgroups(&self) -> &wgpu::Buffer {
        &self.workgroups
    }

    /// State of each grid of the square, as `GRID_SHOWN`; those of the near grids are undefined.
    pub(super) fn states(&self) -> &wgpu::Buffer {
        &self.states
    }

    /// Grids of the listed chunks.
    #[cfg(test)]
    pub(super) fn listed(&self, gpu: &Gpu) -> std::collections::BTreeSet<[i32; 2]> {
        use crate::render::gpu::readback::read;
        let count = bytemuck::pod_collect_to_vec::<u8, u32>(&read(gpu, &self.workgroups))[0];
        let chunks: Vec<[i32; 4]> = bytemuck::pod_collect_to_vec(&read(gpu, &self.chunks));
        chunks.iter().take(count as usize).map(|&[x, z, ..]| [x, z]).collect()
    }

    /// First grid of the square, and grids along its side.
    pub(super) fn square(&self) -> ([i32; 2], i32) {
        (self.frame.first_grid, self.frame.side)
    }

    pub(super) fn prepare(&mut self, from: &Viewpoint<'_>, home: [i32; 2], plants_of_grid: u32) {
        let side = side(from.detail, self.grid_m) as i32;
        self.frame = Squares {
            first_grid: home.map(|n| n - side / 2),
            side,
            culls: i32::from(from.options.culls),
            grid_plants: plants_of_grid,
            chunk_limit: self.capacity,
            near_grids: NEAR_GRIDS as u32,
            grid_m: self.grid_m,
            full_density_m: from.detail.full_m,
            reach_m: from.detail.blades_m,
            plant_reach_m: self.beyond_m,
            heads_thin_m: from.detail.heads_m,
            ..self.frame
        };
    }

    /// Batches of a frame: one, except at reference quality.
    pub(super) fn batches(&self) -> u32 {
        let side = self.frame.side as u32;
        (side * side).div_ceil(self.grids_per_batch)
    }

    /// Selects the grids of a batch.
    pub(super) fn begin_batch(&mut self, gpu: &Gpu, batch: u32) {
        (self.frame.first, self.frame.end) = (batch * self.grids_per_batch, (batch + 1) * self.grids_per_batch);
        gpu.queue.write_buffer(&self.squares, 0, bytemuck::bytes_of(&self.frame));
        gpu.queue.write_buffer(&self.workgroups, 0, &[0; 4]);
    }

    /// Lists the grids of a batch; if `occludes`, without those that solids hide.
    pub(super) fn list(&self, pass: &mut wgpu::ComputePass<'_>, occludes: bool) {
        pass.set_pipeline(self.list.with([occludes]));
        pass.set_bind_group(1, &self.group, &[]);
        let side = self.frame.side as u32;
        pass.dispatch_workgroups((side * side).div_ceil(CHUNK), 1, 1);
    }
}

fn list_pipelines(factory: PassFactory, layout: wgpu::BindGroupLayout) -> OcclusionVariants<wgpu::ComputePipeline> {
    OcclusionVariants::tested(move |constants| {
        factory.compute("list_grids", &factory.shader("grids", shaders::GRIDS, &constants), "list_grids", &layout)
    })
}

/// Grids along a side of the square that contains all plants in reach; odd, so that the camera is in its central grid.
fn side(detail: &Detail, grid_m: f32) -> u32 {
    2 * (detail.blades_m / grid_m).ceil() as u32 + 1
}

/// Maximum number of chunks per batch: those of the grids nearest to a camera on the ground, at the border of its grid.
fn chunk_limit(detail: &Detail, grid_m: f32, places: u32, grids_per_batch: u32) -> u32 {
    let reach = (side(detail, grid_m) / 2) as i32;
    let mut of_grids: Vec<u32> = square(reach)
        .filter(|[dx, dz]| dx.abs().max(dz.abs()) > NEAR_GRIDS)
        .map(|away| {
            let [x, z] = away.map(|n| (n.abs() - 1).max(0) as f32 * grid_m);
            let stands = places as f32 * density(x.hypot(z), detail.full_m);
            (stands.ceil() as u32).div_ceil(CHUNK)
        })
        .collect();
    of_grids.sort_unstable_by(|a, b| b.cmp(a));
    of_grids.iter().take(grids_per_batch as usize).sum::<u32>().max(1)
}

fn square(reach: i32) -> impl Iterator<Item = [i32; 2]> {
    (-reach..=reach).flat_map(move |z| (-reach..=reach).map(move |x| [x, z]))
}

/// Maximum distance of a part of a plant from its grid (m).
fn beyond_m(decoded: &DecodedScene) -> f32 {
    let scene = decoded.scene();
    scene.plants.most_grown() * scene.tallest_m() + TUFT_REACH_M
}

/// Corners of a box around all plants of a grid (m).
pub(super) fn bounds_m(decoded: &DecodedScene, grid: [i32; 2], grid_m: f32) -> [Vec3; 2] {
    square_bounds_m(decoded, grid.map(|n| n as f32 * grid_m), grid_m)
}

fn square_bounds_m(decoded: &DecodedScene, corner_m: [f32; 2], side_m: f32) -> [Vec3; 2] {
    let beyond_m = beyond_m(decoded);
    let (low, high) = (corner_m.map(|m| m - beyond_m), corner_m.map(|m| m + side_m + beyond_m));
    let [lowest, highest] = heights_within(decoded, low, high);
    [Vec3::new(low[0], lowest - beyond_m, low[1]), Vec3::new(high[0], highest + beyond_m, high[1])]
}

/// Range of ground heights in a rectangle (m). Beyond the edge of the map it is the range at the edge plus the bounds of the hills; `grids.wgsl` evaluates
/// the hills themselves.
fn heights_within(decoded: &DecodedScene, low: [f32; 2], high: [f32; 2]) -> [f32; 2] {
    let heights = decoded.heights();
    let (pixel_m, size) = (heights.pixel_m(), heights.size_px());
    let nodes = |axis: usize| -> Range<usize> {
        let last = size[axis] as f32 - 1.0;
        let at = |m: f32| (m / pixel_m[axis]).clamp(0.0, last);
        at(low[axis]).floor() as usize..at(high[axis]).ceil() as usize + 1
    };
    let mut range = [f32::MAX, f32::MIN];
    for z in nodes(1) {
        for x in nodes(0) {
            let height = heights.heights_m()[z * size[0] as usize + x];
            range = [range[0].min(height), range[1].max(height)];
        }
    }
    let extent = decoded.scene().extent_m();
    let outside = [0, 1].map(|axis| (-low[axis]).max(high[axis] - extent[axis]).max(0.0));
    let [below, above] = hills_m(outside[0].hypot(outside[1]));
    [range[0] + below, range[1] + above]
}

/// Whether a plant of a grid may be in view.
pub(crate) fn grid_is_seen(decoded: &DecodedScene, grid: [i32; 2], grid_m: f32, frustum: &Frustum) -> bool {
    square_is_seen(decoded, grid.map(|n| n as f32 * grid_m), grid_m, frustum)
}

/// Whether a plant of a square may be in view.
pub(crate) fn square_is_seen(decoded: &DecodedScene, corner_m: [f32; 2], side_m: f32, frustum: &Frustum) -> bool {
    let [low, high] = square_bounds_m(decoded, corner_m, side_m);
    frustum.sees_box(low, high)
}
