//! Map of the grass grids around the camera over the picture, for debugging (Zhang, Figs 12 to 14): which are culled by the view frustum or by hills, and the
//! level of detail of the others.

use crate::render::gpu::constants::{
    CLUMPS_CULLED, GLYPH_PITCH, GRID_CLASSES, LEGEND_CHARACTERS, LEGEND_DIGITS, LEGEND_LINE, NEAR_CULLED, NEAR_SHOWN, WORKGROUP_SIZE,
};
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{PassFactory, bind_as, storage, storage_rw, uniform};
use crate::render::gpu::shaders;
use crate::render::gpu::uniforms::GridMapFrame;
use crate::render::options::detail::Detail;
use crate::render::plants::billboards::Billboards;
use crate::render::plants::blades::Blades;
use crate::render::plants::grid_map_legend::glyphs;
use std::ops::Range;
use wgpu::BufferUsages;

/// Side of the map, and width of the legend (pixels of the legend).
const MAP_PX: u32 = (1 + LEGEND_DIGITS + 1 + LEGEND_CHARACTERS) * GLYPH_PITCH;
/// Height of map and legend (pixels of the legend).
const HEIGHT_PX: u32 = MAP_PX + GRID_CLASSES * LEGEND_LINE + 1;
/// Shorter side of a target for each pixel of the target along a side of a pixel of the legend.
const TARGET_PX: u32 = 240;
/// Distance from the corner of the target, in pixels of the legend.
const MARGIN_PX: u32 = 4;

/// The map, with its newest contents on the GPU.
pub(crate) struct GridMap {
    class: wgpu::ComputePipeline,
    draw: wgpu::RenderPipeline,
    class_group: wgpu::BindGroup,
    draw_group: wgpu::BindGroup,
    frame: wgpu::Buffer,
    listed: wgpu::Buffer,
    counts: wgpu::Buffer,
    /// Maximum number of grids along its side.
    side_limit: i32,
    target_encodes: bool,
    side: i32,
    /// Corner, width and height in the target (px).
    area_px: [u32; 4],
}

impl GridMap {
    /// A map of the grids of `blades`, for targets of this format. `detail` is the greatest that is drawn.
    pub(crate) fn new(factory: &PassFactory, blades: &Blades, detail: &Detail, grid_m: f32, target: wgpu::TextureFormat) -> Self {
        let gpu = &factory.gpu;
        let side_limit = side(detail.blades_m.max(detail.far_m), grid_m);
        let grids = (side_limit * side_limit) as u64;
        let stored = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let frame = gpu.empty_buffer("grid map", size_of::<GridMapFrame>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let listed = gpu.empty_buffer("listed grids", 4 * grids, stored);
        let classes = gpu.empty_buffer("classes of grids", 8 * grids, BufferUsages::STORAGE);
        let counts = gpu.empty_buffer("numbers of grids", 4 * u64::from(GRID_CLASSES), stored | BufferUsages::COPY_SRC);
        let legend = gpu.buffer("legend", bytemuck::cast_slice(&glyphs()), BufferUsages::STORAGE);
        let module = factory.shader("grid map", shaders::GRID_MAP, &[]);
        let layout = factory.layout("classes of grids", &[uniform(0), storage(1), storage(2), storage_rw(3), storage_rw(4)]);
        let (states, ..) = blades.far_grids();
        let of_class = [(0, &frame), (1, &listed), (2, states), (3, &classes), (4, &counts)];
        let class_group = bind_as(gpu, "classes of grids", &layout, &of_class);
        let draw_layout = factory.layout("grid map", &[uniform(0), storage(5), storage(6), storage(7)]);
        let draw_group = bind_as(gpu, "grid map", &draw_layout, &[(0, &frame), (5, &classes), (6, &counts), (7, &legend)]);
        Self {
            class: factory.compute("class_grids", &module, "class_grids", &layout),
            draw: factory.output_pipeline("grid map", &module, "fs", &draw_layout, target),
            class_group,
            draw_group,
            frame,
            listed,
            counts,
            side_limit,
            target_encodes: target.is_srgb(),
            side: 1,
            area_px: [0; 4],
        }
    }

    /// Sets the contents of the map of a frame, for these columns of a target of this size. Without clumps it shows the grids of single plants alone.
    pub(crate) fn prepare(
        &mut self,
        gpu: &Gpu,
        blades: &Blades,
        clumps: Option<&Billboards>,
        detail: &Detail,
        grid_m: f32,
        (columns, size_px): (&Range<u32>, [u32; 2]),
    ) {
        let reach_m = if clumps.is_some() { detail.blades_m.max(detail.far_m) } else { detail.blades_m };
        self.side = side(reach_m, grid_m).min(self.side_limit);
        let (_, listed_first, listed_side) = blades.far_grids();
        let first_grid = listed_first.map(|n| n + listed_side / 2 - self.side / 2);
        let pixel_px = (size_px[0].min(size_px[1]) / TARGET_PX).max(1);
        let corner_px = [columns.start + MARGIN_PX * pixel_px, MARGIN_PX * pixel_px];
        let end_px = [columns.end, size_px[1]];
        let shown = |axis: usize, px: u32| (px * pixel_px).min(end_px[axis].saturating_sub(corner_px[axis]));
        self.area_px = [corner_px[0], corner_px[1], shown(0, MAP_PX), shown(1, HEIGHT_PX)];
        let frame = GridMapFrame {
            first_grid,
            listed_first,
            side: self.side,
            listed_side,
            grid_m,
            pixel_px: pixel_px as f32,
            corner_px: corner_px.map(|px| px as f32),
            map_px: MAP_PX as f32,
            target_encodes: u32::from(self.target_encodes),
        };
        gpu.queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(&frame));
        gpu.queue.write_buffer(&self.listed, 0, bytemuck::cast_slice(&codes(blades, clumps, first_grid, self.side)));
        gpu.queue.write_buffer(&self.counts, 0, &[0; 4 * GRID_CLASSES as usize]);
    }

    /// Finds the class of each grid, after the pass that lists grids.
    pub(crate) fn class(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(&self.class);
        pass.set_bind_group(1, &self.class_group, &[]);
        pass.dispatch_workgroups(((self.side * self.side) as u32).div_ceil(WORKGROUP_SIZE), 1, 1);
    }

    /// Draws the map into the target.
    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        let [x, y, width, height] = self.area_px;
        if width > 0 && height > 0 {
            pass.set_scissor_rect(x, y, width, height);
            pass.set_pipeline(&self.draw);
            pass.set_bind_group(1, &self.draw_group, &[]);
            pass.draw(0..3, 0..1);
        }
    }

    /// Numbers of grids of the classes, in the order of the legend.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn counts(&self) -> &wgpu::Buffer {
        &self.counts
    }
}

/// Grids along the side of a square around the camera's that reaches this far.
fn side(reach_m: f32, grid_m: f32) -> i32 {
    2 * (reach_m / grid_m).ceil() as i32 + 1
}

/// Codes of the grids of a square, row by row: near ones and those with clumps.
fn codes(blades: &Blades, clumps: Option<&Billboards>, first: [i32; 2], side: i32) -> Vec<u32> {
    let mut codes = vec![0; (side * side) as usize];
    let mut set = |grid: [i32; 2], code: u32| {
        let [x, z] = [grid[0] - first[0], grid[1] - first[1]];
        if (0..side).contains(&x) && (0..side).contains(&z) {
            codes[(z * side + x) as usize] = code;
        }
    };
    for clump in clumps.iter().flat_map(|clumps| clumps.grids()) {
        set(clump.grid, if clump.is_seen { clump.plants } else { clump.plants + CLUMPS_CULLED });
    }
    for &(grid, is_seen) in blades.near_grids() {
        set(grid, if is_seen { NEAR_SHOWN } else { NEAR_CULLED });
    }
    codes
}
