//! Which grass grids beyond the simulated ones have plants to draw: a compute pass lists them, 64 plants a workgroup, so that the work of the CPU does not
//! grow with their number (000 section 5.3).

use super::horizon::Lowest;
use super::{CHUNK, Standpoint, TURN_LIMIT, density};
use crate::render::cull::Frustum;
use crate::render::detail::Detail;
use crate::render::gpu::Gpu;
use crate::render::pipeline::{Maker, bind, sampled, storage_rw, uniform};
use crate::render::shaders;
use crate::render::uniforms::Squares;
use crate::state::Land;
use glam::Vec3;
use std::ops::Range;
use wgpu::{BindingResource, BufferUsages, TextureSampleType, TextureViewDimension};

/// Grids on each side of the camera's that are simulated, and so not listed.
const NEAR_GRIDS: i32 = 1;
/// Plants of a tuft draw together from beyond their grid's border (m).
const BESIDE_M: f32 = 0.5;

pub(super) struct Grids {
    list: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    squares: wgpu::Buffer,
    chunks: wgpu::Buffer,
    workgroups: wgpu::Buffer,
    grid_m: f32,
    /// How far plants reach beyond their places (m).
    pub(super) beyond_m: f32,
    /// Most chunks that are listed.
    pub(super) capacity: u32,
    /// Grids that are listed in one turn.
    of_turn: u32,
    frame: Squares,
}

impl Grids {
    /// `places` plants fit in a grid; all of them are listed at once, or by turns.
    pub(super) fn new(maker: &Maker<'_>, land: &Land, detail: &Detail, places: u32, by_turns: bool) -> Self {
        let gpu = maker.gpu;
        let grid_m = land.scene().plants.grid_m;
        let side = side(detail, grid_m);
        let of_turn = if by_turns { (TURN_LIMIT / places.max(1)).max(1) } else { side * side };
        let capacity = chunk_limit(detail, grid_m, places, of_turn);
        let layout = maker.layout(
            "grids",
            &[
                uniform(0),
                storage_rw(1),
                storage_rw(2),
                sampled(3, TextureSampleType::Float { filterable: false }, TextureViewDimension::D2),
            ],
        );
        let squares = gpu.empty_buffer("squares", size_of::<Squares>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let chunks = gpu.empty_buffer("chunks", u64::from(capacity) * 16, BufferUsages::STORAGE);
        let usage = BufferUsages::STORAGE | BufferUsages::INDIRECT | BufferUsages::COPY_DST;
        let workgroups = gpu.buffer("workgroups", bytemuck::bytes_of(&[0_u32, 1, 1]), usage);
        let lowest = Lowest::new(land, grid_m);
        let [cell_x_m, cell_z_m] = lowest.cell_m;
        let lowest = lowest.texture(gpu);
        let [own, listed, counted] = [&squares, &chunks, &workgroups].map(|buffer| buffer.as_entire_binding());
        let group = bind(gpu, "grids", &layout, &[own, listed, counted, BindingResource::TextureView(&lowest)]);
        let list = maker.compute("list_grids", &maker.shader("grids", shaders::GRIDS, &[]), "list_grids", &layout);
        let beyond_m = beyond_m(land);
        let frame = Squares { cells: [cell_x_m, cell_z_m, 0.0, 0.0], ..bytemuck::Zeroable::zeroed() };
        Self { list, group, squares, chunks, workgroups, grid_m, beyond_m, capacity, of_turn, frame }
    }

    /// The listed chunks.
    pub(super) fn chunks(&self) -> &wgpu::Buffer {
        &self.chunks
    }

    /// How many there are, for an indirect dispatch.
    pub(super) fn workgroups(&self) -> &wgpu::Buffer {
        &self.workgroups
    }

    pub(super) fn prepare(&mut self, from: &Standpoint<'_>, home: [i32; 2], plants_of_grid: u32) {
        let side = side(from.detail, self.grid_m) as i32;
        let first = home.map(|n| n - side / 2);
        self.frame = Squares {
            window: [first[0], first[1], side, i32::from(from.look.culls)],
            counts: [plants_of_grid, self.capacity, NEAR_GRIDS as u32, 0],
            shape: [self.grid_m, from.detail.full_m, from.detail.blades_m, self.beyond_m],
            ..self.frame
        };
    }

    /// Turns that a frame needs: one, but where every plant is drawn.
    pub(super) fn turns(&self) -> u32 {
        let side = self.frame.window[2] as u32;
        (side * side).div_ceil(self.of_turn)
    }

    /// Lists the grids of this turn from now on.
    pub(super) fn begin_turn(&mut self, gpu: &Gpu, turn: u32) {
        self.frame.turn = [turn * self.of_turn, (turn + 1) * self.of_turn, 0, 0];
        gpu.queue.write_buffer(&self.squares, 0, bytemuck::bytes_of(&self.frame));
        gpu.queue.write_buffer(&self.workgroups, 0, &[0; 4]);
    }

    pub(super) fn list(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(&self.list);
        pass.set_bind_group(1, &self.group, &[]);
        let side = self.frame.window[2] as u32;
        pass.dispatch_workgroups((side * side).div_ceil(CHUNK), 1, 1);
    }
}

/// Grids along the side of the square that holds all plants in reach; odd, so that the camera's is in its middle.
fn side(detail: &Detail, grid_m: f32) -> u32 {
    2 * (detail.blades_m / grid_m).ceil() as u32 + 1
}

/// Most chunks of a turn: those of the grids nearest to a camera that stands on the land, at the border of its own grid.
fn chunk_limit(detail: &Detail, grid_m: f32, places: u32, of_turn: u32) -> u32 {
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
    of_grids.iter().take(of_turn as usize).sum::<u32>().max(1)
}

fn square(reach: i32) -> impl Iterator<Item = [i32; 2]> {
    (-reach..=reach).flat_map(move |z| (-reach..=reach).map(move |x| [x, z]))
}

/// How far plants reach beyond their grid (m).
fn beyond_m(land: &Land) -> f32 {
    let scene = land.scene();
    scene.plants.most_grown() * scene.tallest_m() + BESIDE_M
}

/// Corners of a box about all plants of a grid (m).
pub(super) fn bounds_m(land: &Land, grid: [i32; 2], grid_m: f32) -> [Vec3; 2] {
    square_bounds_m(land, grid.map(|n| n as f32 * grid_m), grid_m)
}

fn square_bounds_m(land: &Land, corner_m: [f32; 2], side_m: f32) -> [Vec3; 2] {
    let beyond_m = beyond_m(land);
    let (low, high) = (corner_m.map(|m| m - beyond_m), corner_m.map(|m| m + side_m + beyond_m));
    let [lowest, highest] = heights_within(land, low, high);
    [Vec3::new(low[0], lowest - beyond_m, low[1]), Vec3::new(high[0], highest + beyond_m, high[1])]
}

/// Lowest and highest land of a rectangle (m); beyond the world's edge as at it, give or take what hills rise to there. Its like in `grids.wgsl` asks the
/// hills themselves.
fn heights_within(land: &Land, low: [f32; 2], high: [f32; 2]) -> [f32; 2] {
    let heights = land.heights();
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
    let extent = land.scene().extent_m();
    let outside = [0, 1].map(|axis| (-low[axis]).max(high[axis] - extent[axis]).max(0.0));
    let hills_m = hills_limit_m(outside[0].hypot(outside[1]));
    [range[0] - hills_m, range[1] + hills_m]
}

/// Most that the hills beyond the world's edge rise or fall so far from it (m); see `far_hills` in `common.wgsl`.
fn hills_limit_m(outside_m: f32) -> f32 {
    let rise = (outside_m / 900.0).min(1.0);
    rise * rise * (3.0 - 2.0 * rise) * (0.58 * 150.0 + 0.006 * outside_m)
}

/// Whether any plant of a grid may be in view.
pub(in crate::render) fn grid_is_seen(land: &Land, grid: [i32; 2], grid_m: f32, frustum: &Frustum) -> bool {
    square_is_seen(land, grid.map(|n| n as f32 * grid_m), grid_m, frustum)
}

/// Whether any plant of a square from a corner on may be in view.
pub(in crate::render) fn square_is_seen(land: &Land, corner_m: [f32; 2], side_m: f32, frustum: &Frustum) -> bool {
    let [low, high] = square_bounds_m(land, corner_m, side_m);
    frustum.sees_box(low, high)
}
