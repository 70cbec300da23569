//! Shells (003): grass as layers of cross-sections over the ground's own mesh, fewer the farther away.

use super::blades::square_is_seen;
use super::cull::Frustum;
use super::dots::{self, DOTS, DOTS_PX};
use super::gpu::Gpu;
use super::pipeline::{Draw, Maker, storage, storage_rw, texture, uniform};
use super::shaders;
use super::terrain::{Ground, TILE_VERTICES, Tile, tile_indices};
use super::uniforms::ShellFrame;
use crate::state::Land;
use glam::Vec3;
use shared::lod::shells::{LAYERS_LIMIT, drawn_layers};
use wgpu::BufferUsages;

/// Side of the tiles about the camera (m); of their sixteen cells each, all layers share the wind at the corners.
const FINEST_M: f32 = 4.0;
/// Most tiles in a frame, and most layers of them together.
const TILE_LIMIT: usize = 384;
const SHEET_LIMIT: usize = 16_384;
/// Bytes of `Turf` in `shells.wgsl`.
pub(super) const TURF_BYTES: u64 = 96;

/// A layer of a tile: its number and the tile's, segments down to the next that is drawn and to the one after that, 1 if it goes where the next coarser tiles begin.
/// Twin of `sheets` in `shells.wgsl`.
type Sheet = [u32; 4];

/// Where shells stand for grass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Extent {
    /// Everywhere.
    All,
    /// Beyond the single blades.
    Far,
}

/// What of the shells a frame shows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    pub(super) extent: Extent,
    /// `reach` of the frame's uniforms (m).
    pub(super) reach_m: [f32; 4],
    /// Layers near the camera, the ground among them; the scene's if none.
    pub(super) layers: Option<u32>,
}

pub(super) struct Shells {
    pipeline: wgpu::RenderPipeline,
    settle: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    settle_group: wgpu::BindGroup,
    indices: wgpu::Buffer,
    index_count: u32,
    tiles: wgpu::Buffer,
    frame: wgpu::Buffer,
    sheets: wgpu::Buffer,
    ground: Ground,
    tile_count: u32,
    sheet_count: u32,
    samples: u32,
}

impl Shells {
    pub(super) fn new(maker: &Maker<'_>, land: &Land, ground: &Ground) -> Self {
        let gpu = maker.gpu;
        let layout = maker.layout("shells", &[uniform(1), storage(2), texture(3), storage(4)]);
        let settle_layout = maker.layout("turf", &[storage(0), uniform(1), storage_rw(5)]);
        let module = maker.shader("shells", shaders::SHELLS, &[]);
        let draw = Draw { label: "shells", ..Draw::default() };
        let listed = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let tiles = gpu.empty_buffer("shell tiles", (TILE_LIMIT * size_of::<Tile>()) as u64, listed);
        let sheets = gpu.empty_buffer("shell sheets", (SHEET_LIMIT * size_of::<Sheet>()) as u64, listed);
        let frame = gpu.empty_buffer("shells", size_of::<ShellFrame>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let turfs = gpu.empty_buffer("turf", TILE_LIMIT as u64 * u64::from(TILE_VERTICES) * TURF_BYTES, BufferUsages::STORAGE);
        let levels = dots::dots(land.scene().plants.height_variation);
        let dots = gpu.texture("dots", wgpu::TextureFormat::Rgba8Unorm, [DOTS_PX; 2], &levels).create_view(&Default::default());
        let [listed_tiles, uniforms, settled, listed_sheets] = [&tiles, &frame, &turfs, &sheets].map(|buffer| buffer.as_entire_binding());
        let group_of = |label, layout: &wgpu::BindGroupLayout, entries: &[(u32, wgpu::BindingResource<'_>)]| {
            let entries: Vec<_> =
                entries.iter().map(|(binding, resource)| wgpu::BindGroupEntry { binding: *binding, resource: resource.clone() }).collect();
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
        };
        let dots = wgpu::BindingResource::TextureView(&dots);
        let drawn = [(1, uniforms.clone()), (2, settled.clone()), (3, dots), (4, listed_sheets)];
        let indices = tile_indices();
        Self {
            pipeline: maker.draw(&module, Some(&layout), &draw),
            settle: maker.compute("turf", &module, "settle_turf", &settle_layout),
            group: group_of("shells", &layout, &drawn),
            settle_group: group_of("turf", &settle_layout, &[(0, listed_tiles), (1, uniforms), (5, settled)]),
            index_count: indices.len() as u32,
            indices: gpu.buffer("shell tile", bytemuck::cast_slice(&indices), BufferUsages::INDEX),
            ground: ground.finer(FINEST_M),
            tiles,
            frame,
            sheets,
            tile_count: 0,
            sheet_count: 0,
            samples: maker.samples,
        }
    }

    /// Lists the layers in view, nearest tiles and topmost layers first, so that what they hide is not coloured.
    pub(super) fn prepare(&mut self, gpu: &Gpu, land: &Land, eye_m: Vec3, frustum: &Frustum, wanted: Wanted) {
        let Wanted { extent, reach_m: reach, layers } = wanted;
        let settings = &land.scene().shells;
        let segments = layers.unwrap_or(settings.layers).clamp(1, LAYERS_LIMIT) - 1;
        let is_needed = |tile: &Tile| {
            let [nearest_m, farthest_m] = tile.distances_m(eye_m);
            let middle = tile.corner_m.map(|corner| corner + 0.5 * tile.side_m);
            let above_m = (eye_m.y - land.heights().height_m(middle[0], middle[1])).abs() + 0.5 * tile.side_m;
            let is_hidden = extent == Extent::Far && farthest_m.hypot(above_m) < reach[0];
            nearest_m < reach[3] && !is_hidden && square_is_seen(land, tile.corner_m, tile.side_m, frustum)
        };
        let mut tiles: Vec<_> = self.ground.tiles(eye_m, frustum).into_iter().filter(is_needed).collect();
        tiles.truncate(TILE_LIMIT);
        let mut sheets: Vec<Sheet> =
            (0..).zip(&tiles).flat_map(|(number, tile)| sheets_of(number, segments, (tile.side_m / FINEST_M) as u32)).collect();
        sheets.truncate(SHEET_LIMIT);
        let side_m = (DOTS as f32 / settings.blades_per_m2).sqrt();
        let frame = ShellFrame {
            counts: [segments, settings.slices, u32::from(extent == Extent::All), self.samples],
            dots: [side_m, side_m / DOTS_PX as f32, (dots::LEVELS - 1) as f32, settings.root_light],
        };
        gpu.queue.write_buffer(&self.tiles, 0, bytemuck::cast_slice(&tiles));
        gpu.queue.write_buffer(&self.sheets, 0, bytemuck::cast_slice(&sheets));
        gpu.queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(&frame));
        self.tile_count = tiles.len() as u32;
        self.sheet_count = sheets.len() as u32;
    }

    /// Layers of tiles in the frame.
    pub(super) fn sheets(&self) -> u32 {
        self.sheet_count
    }

    /// Finds how the grass stands at the tiles' vertices.
    pub(super) fn bend(&self, pass: &mut wgpu::ComputePass<'_>) {
        if self.tile_count > 0 {
            pass.set_pipeline(&self.settle);
            pass.set_bind_group(1, &self.settle_group, &[]);
            pass.dispatch_workgroups(TILE_VERTICES.div_ceil(64), self.tile_count, 1);
        }
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &self.group, &[]);
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint16);
        pass.draw_indexed(0..self.index_count, 0, 0..self.sheet_count);
    }
}

/// Layers of a tile where each `stride`-th of so many is drawn; without any above the ground, the ground's own.
fn sheets_of(tile: u32, segments: u32, stride: u32) -> Vec<Sheet> {
    if segments == 0 {
        return vec![[tile << 8, 0, 0, 0]];
    }
    let stride = stride.clamp(1, segments);
    let next = (2 * stride).min(segments);
    let sheet =
        |(layer, below): (u32, u32)| [tile << 8 | layer, below, next.min(layer), u32::from(!(segments - layer).is_multiple_of(next))];
    drawn_layers(segments, stride).map(sheet).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_that_remain_reach_down_to_the_next_that_remains() {
        for segments in [1, 8, 16, 21, 64] {
            for stride in [1, 2, 4, 16, 128] {
                let sheets = sheets_of(3, segments, stride);
                assert_eq!(sheets[0], [3 << 8 | segments, stride.min(segments), (2 * stride).min(segments), 0]);
                let remain: Vec<_> = sheets.iter().filter(|sheet| sheet[3] == 0).collect();
                let layer = |sheet: &Sheet| sheet[0] & 255;
                assert!(remain.windows(2).all(|pair| layer(pair[0]) - pair[0][2] == layer(pair[1])), "{sheets:?}");
                assert_eq!(layer(remain[remain.len() - 1]), remain[remain.len() - 1][2]);
            }
        }
        assert_eq!(sheets_of(2, 0, 4), [[2 << 8, 0, 0, 0]]);
    }
}
