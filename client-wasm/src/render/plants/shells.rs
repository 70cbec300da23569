//! Shells (Bakay): grass as layers of cross-sections over the mesh of the ground, fewer with distance.

use crate::render::gpu::constants::{TILE_VERTICES, WORKGROUP_SIZE};
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{DrawDescriptor, PassFactory, storage, storage_rw, texture, uniform};
use crate::render::gpu::shaders;
use crate::render::gpu::uniforms::ShellFrame;
use crate::render::inputs::frustum::Frustum;
use crate::render::land_and_sky::terrain::{TerrainQuadtree, TerrainTile, tile_indices};
use crate::render::plants::blades::square_is_seen;
use crate::render::plants::shell_texture;
use crate::render::plants::shell_texture::{DOTS, DOTS_PX};
use crate::state::DecodedScene;
use glam::Vec3;
use prairie_core::lod::shells::{LAYERS_LIMIT, drawn_layers};
use wgpu::BufferUsages;

/// Side of the finest tiles (m). All layers share the wind at the corners of their 16 × 16 cells.
const FINEST_M: f32 = 4.0;
/// Maximum number of tiles in a frame, and of their layers.
const TILE_LIMIT: usize = 384;
const SHEET_LIMIT: usize = 16_384;
/// Bytes of `Turf` in `shells.wgsl`.
pub(crate) const TURF_BYTES: u64 = 96;

/// A layer of a tile: its number and that of the tile, segments down to the next drawn layer and to the one after that, 1 if it ends where the next coarser
/// tiles begin. Element of `sheets` in `shells.wgsl`.
type Sheet = [u32; 4];

/// Where shells replace blades.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ShellExtent {
    /// Everywhere.
    All,
    /// Beyond the single blades.
    BeyondBlades,
}

/// Shells that a frame shows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShellRequest {
    pub(crate) extent: ShellExtent,
    /// Distance at which near blades begin to fade out (m).
    pub(crate) from_m: f32,
    /// Distance at which shells end (m).
    pub(crate) end_m: f32,
    /// Layers near the camera, including the ground; `None`: the setting of the scene.
    pub(crate) layers: Option<u32>,
}

pub(crate) struct Shells {
    pipeline: wgpu::RenderPipeline,
    settle: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    settle_group: wgpu::BindGroup,
    indices: wgpu::Buffer,
    index_count: u32,
    tiles: wgpu::Buffer,
    frame: wgpu::Buffer,
    sheets: wgpu::Buffer,
    ground: TerrainQuadtree,
    tile_count: u32,
    sheet_count: u32,
    samples: u32,
}

impl Shells {
    pub(crate) fn new(factory: &PassFactory<'_>, decoded: &DecodedScene, ground: &TerrainQuadtree) -> Self {
        let gpu = factory.gpu;
        let layout = factory.layout("shells", &[uniform(1), storage(2), texture(3), storage(4)]);
        let settle_layout = factory.layout("turf", &[storage(0), uniform(1), storage_rw(5)]);
        let module = factory.shader("shells", shaders::SHELLS, &[]);
        let draw = DrawDescriptor { label: "shells", ..DrawDescriptor::default() };
        let listed = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let tiles = gpu.empty_buffer("shell tiles", (TILE_LIMIT * size_of::<TerrainTile>()) as u64, listed);
        let sheets = gpu.empty_buffer("shell sheets", (SHEET_LIMIT * size_of::<Sheet>()) as u64, listed);
        let frame = gpu.empty_buffer("shells", size_of::<ShellFrame>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let turfs = gpu.empty_buffer("turf", TILE_LIMIT as u64 * u64::from(TILE_VERTICES) * TURF_BYTES, BufferUsages::STORAGE);
        let levels = shell_texture::dots(decoded.scene().plants.height_variation);
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
            pipeline: factory.draw(&module, Some(&layout), &draw),
            settle: factory.compute("turf", &module, "settle_turf", &settle_layout),
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
            samples: factory.samples,
        }
    }

    /// Lists the layers in view, nearest tiles and topmost layers first, so that hidden fragments are not shaded.
    pub(crate) fn prepare(&mut self, gpu: &Gpu, decoded: &DecodedScene, eye_m: Vec3, frustum: &Frustum, wanted: ShellRequest) {
        let ShellRequest { extent, from_m, end_m, layers } = wanted;
        let settings = &decoded.scene().shells;
        let segments = layers.unwrap_or(settings.layers).clamp(1, LAYERS_LIMIT) - 1;
        let is_needed = |tile: &TerrainTile| {
            let [nearest_m, farthest_m] = tile.distances_m(eye_m);
            let middle = tile.corner_m.map(|corner| corner + 0.5 * tile.side_m);
            let above_m = (eye_m.y - decoded.heights().height_m(middle[0], middle[1])).abs() + 0.5 * tile.side_m;
            let is_hidden = extent == ShellExtent::BeyondBlades && farthest_m.hypot(above_m) < from_m;
            nearest_m < end_m && !is_hidden && square_is_seen(decoded, tile.corner_m, tile.side_m, frustum)
        };
        let mut tiles: Vec<_> = self.ground.tiles(eye_m, frustum).into_iter().filter(is_needed).collect();
        tiles.truncate(TILE_LIMIT);
        let mut sheets: Vec<Sheet> =
            (0..).zip(&tiles).flat_map(|(number, tile)| sheets_of(number, segments, (tile.side_m / FINEST_M) as u32)).collect();
        sheets.truncate(SHEET_LIMIT);
        let side_m = (DOTS as f32 / settings.blades_per_m2).sqrt();
        let frame = ShellFrame {
            segments,
            slice_limit: settings.slices,
            is_alone: u32::from(extent == ShellExtent::All),
            samples: self.samples,
            texture_m: side_m,
            texel_m: side_m / DOTS_PX as f32,
            last_level: (shell_texture::LEVELS - 1) as f32,
            root_light: settings.root_light,
        };
        gpu.queue.write_buffer(&self.tiles, 0, bytemuck::cast_slice(&tiles));
        gpu.queue.write_buffer(&self.sheets, 0, bytemuck::cast_slice(&sheets));
        gpu.queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(&frame));
        self.tile_count = tiles.len() as u32;
        self.sheet_count = sheets.len() as u32;
    }

    /// Number of layers in the frame, summed over all tiles.
    pub(crate) fn layer_count(&self) -> u32 {
        self.sheet_count
    }

    /// Computes the posture of the grass at the vertices of the tiles.
    pub(crate) fn bend(&self, pass: &mut wgpu::ComputePass<'_>) {
        if self.tile_count > 0 {
            pass.set_pipeline(&self.settle);
            pass.set_bind_group(1, &self.settle_group, &[]);
            pass.dispatch_workgroups(TILE_VERTICES.div_ceil(WORKGROUP_SIZE), self.tile_count, 1);
        }
    }

    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &self.group, &[]);
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint16);
        pass.draw_indexed(0..self.index_count, 0, 0..self.sheet_count);
    }
}

/// Layers of a tile with `segments` between them, of which every `stride`-th is drawn; with 0 segments, the ground alone.
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
    fn remaining_layers_reach_down_to_the_next_one() {
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
