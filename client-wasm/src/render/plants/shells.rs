//! Shells (Bakay): grass as layers of cross-sections over the mesh of the ground, fewer with distance.

use crate::render::gpu::constants::{TILE_VERTICES, WORKGROUP_SIZE};
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{DrawDescriptor, PassFactory, bind_at, storage, storage_rw, texture, uniform};
use crate::render::gpu::shaders;
use crate::render::gpu::uniforms::ShellFrame;
use crate::render::gpu::variants::LampVariants;
use crate::render::inputs::frustum::Frustum;
use crate::render::land_and_sky::terrain::tile_indices;
use crate::render::land_and_sky::terrain_quadtree::{GroundTile, TerrainQuadtree};
use crate::render::plants::blades::square_is_seen;
use crate::render::plants::force_field::CameraForceField;
use crate::render::plants::shell_texture;
use crate::render::plants::shell_texture::{DOTS, DOTS_PX};
use crate::state::DecodedScene;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use prairie_core::lod::shells::{LAYERS_LIMIT, drawn_layers};
use prairie_core::scene::ShellExtrusion;
use wgpu::BufferUsages;

/// Side of the finest tiles (m). All layers share the wind at the corners of their 16 × 16 cells.
const FINEST_M: f32 = 4.0;
/// Maximum number of tiles in a frame, and of their layers.
const TILE_LIMIT: usize = 384;
const LAYER_LIMIT: usize = 16_384;
/// Bytes of `Turf` in `shells.wgsl`.
pub(crate) const TURF_BYTES: u64 = 96;

/// A layer of a tile to be drawn, as in `shells.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct TileLayer {
    /// Number of the layer in the low byte, number of the tile above it.
    tile_and_layer: u32,
    /// Segments down to the next drawn layer.
    to_next: u32,
    /// Segments down to the layer after that one.
    to_second: u32,
    /// 1 if the layer ends where the next coarser tiles begin.
    ends: u32,
}

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
    pipeline: LampVariants<wgpu::RenderPipeline>,
    settle: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    settle_group: wgpu::BindGroup,
    indices: wgpu::Buffer,
    index_count: u32,
    tiles: wgpu::Buffer,
    frame: wgpu::Buffer,
    layers: wgpu::Buffer,
    ground: TerrainQuadtree,
    tile_count: u32,
    layers_drawn: u32,
    samples: u32,
}

impl Shells {
    pub(crate) fn new(factory: &PassFactory, decoded: &DecodedScene, ground: &TerrainQuadtree, forces: &CameraForceField) -> Self {
        let gpu = &factory.gpu;
        let layout = factory.layout("shells", &[uniform(1), storage(2), texture(3), storage(4)]);
        let settle_layout = factory.layout("turf", &[&[storage(0), uniform(1), storage_rw(5)][..], &CameraForceField::layout()].concat());
        let module = factory.shader("turf", shaders::SHELLS, &[]);
        let listed = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let tiles = gpu.empty_buffer("shell tiles", (TILE_LIMIT * size_of::<GroundTile>()) as u64, listed);
        let layers = gpu.empty_buffer("shell layers", (LAYER_LIMIT * size_of::<TileLayer>()) as u64, listed);
        let frame = gpu.empty_buffer("shells", size_of::<ShellFrame>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let turfs = gpu.empty_buffer("turf", TILE_LIMIT as u64 * u64::from(TILE_VERTICES) * TURF_BYTES, BufferUsages::STORAGE);
        let levels = shell_texture::dots(decoded.scene().plants.height_variation);
        let dots = gpu.texture("dots", wgpu::TextureFormat::Rgba8Unorm, [DOTS_PX; 2], &levels).create_view(&Default::default());
        let [listed_tiles, uniforms, settled, listed_layers] = [&tiles, &frame, &turfs, &layers].map(|buffer| buffer.as_entire_binding());
        let drawn = [(1, uniforms.clone()), (2, settled.clone()), (3, wgpu::BindingResource::TextureView(&dots)), (4, listed_layers)];
        let turf = [(0, listed_tiles), (1, uniforms), (5, settled)];
        let indices = tile_indices();
        Self {
            pipeline: pipelines(factory, &layout, decoded.scene().shells.stiffness_profile != 0.0),
            settle: factory.compute("turf", &module, "settle_turf", &settle_layout),
            group: bind_at(gpu, "shells", &layout, drawn),
            settle_group: bind_at(gpu, "turf", &settle_layout, turf.into_iter().chain(forces.resources())),
            index_count: indices.len() as u32,
            indices: gpu.buffer("shell tile", bytemuck::cast_slice(&indices), BufferUsages::INDEX),
            ground: ground.finer(FINEST_M),
            tiles,
            frame,
            layers,
            tile_count: 0,
            layers_drawn: 0,
            samples: factory.samples,
        }
    }

    /// Lists the layers in view, nearest tiles and topmost layers first, so that hidden fragments are not shaded.
    pub(crate) fn prepare(&mut self, gpu: &Gpu, decoded: &DecodedScene, eye_m: Vec3, frustum: &Frustum, wanted: ShellRequest) {
        let ShellRequest { extent, from_m, end_m, layers } = wanted;
        let settings = &decoded.scene().shells;
        let segments = layers.unwrap_or(settings.layers).clamp(1, LAYERS_LIMIT) - 1;
        let is_needed = |tile: &GroundTile| {
            let [nearest_m, farthest_m] = tile.distances_m(eye_m);
            let middle = tile.corner_m.map(|corner| corner + 0.5 * tile.side_m);
            let above_m = (eye_m.y - decoded.heights().height_m(middle[0], middle[1])).abs() + 0.5 * tile.side_m;
            let is_hidden = extent == ShellExtent::BeyondBlades && farthest_m.hypot(above_m) < from_m;
            nearest_m < end_m && !is_hidden && square_is_seen(decoded, tile.corner_m, tile.side_m, frustum)
        };
        let mut tiles: Vec<_> = self.ground.tiles(eye_m, frustum).into_iter().filter(is_needed).collect();
        tiles.truncate(TILE_LIMIT);
        let mut tile_layers: Vec<TileLayer> =
            (0..).zip(&tiles).flat_map(|(number, tile)| layers_of(number, segments, (tile.side_m / FINEST_M) as u32)).collect();
        tile_layers.truncate(LAYER_LIMIT);
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
            stiffness_profile: settings.stiffness_profile,
            is_upright: u32::from(settings.extrusion == ShellExtrusion::Up),
            _pad: [0; 8],
        };
        gpu.queue.write_buffer(&self.tiles, 0, bytemuck::cast_slice(&tiles));
        gpu.queue.write_buffer(&self.layers, 0, bytemuck::cast_slice(&tile_layers));
        gpu.queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(&frame));
        self.tile_count = tiles.len() as u32;
        self.layers_drawn = tile_layers.len() as u32;
    }

    /// Number of layers in the frame, summed over all tiles.
    pub(crate) fn layer_count(&self) -> u32 {
        self.layers_drawn
    }

    /// Creates a variant of a pipeline that no frame has needed yet. Returns false if there is none.
    pub(crate) fn create_next(&self) -> bool {
        self.pipeline.create_next()
    }

    /// Computes the posture of the grass at the vertices of the tiles.
    pub(crate) fn bend(&self, pass: &mut wgpu::ComputePass<'_>) {
        if self.tile_count > 0 {
            pass.set_pipeline(&self.settle);
            pass.set_bind_group(1, &self.settle_group, &[]);
            pass.dispatch_workgroups(TILE_VERTICES.div_ceil(WORKGROUP_SIZE), self.tile_count, 1);
        }
    }

    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, has_lamps: bool) {
        pass.set_pipeline(self.pipeline.of(has_lamps));
        pass.set_bind_group(1, &self.group, &[]);
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint16);
        pass.draw_indexed(0..self.index_count, 0, 0..self.layers_drawn);
    }
}

/// Pipelines without and with lamps, for a constant increment of the tilt or another stiffness profile.
fn pipelines(factory: &PassFactory, layout: &wgpu::BindGroupLayout, has_profile: bool) -> LampVariants<wgpu::RenderPipeline> {
    let (factory, layout) = (factory.clone(), layout.clone());
    LampVariants::new(move |[lamps]| {
        let module = factory.shader("shells", shaders::SHELLS, &[lamps, ("has_profile", has_profile)]);
        factory.draw(&module, Some(&layout), &DrawDescriptor { label: "shells", ..DrawDescriptor::default() })
    })
}

/// Layers of a tile with `segments` between them, of which every `stride`-th is drawn; with 0 segments, the ground alone.
fn layers_of(tile: u32, segments: u32, stride: u32) -> Vec<TileLayer> {
    if segments == 0 {
        return vec![TileLayer { tile_and_layer: tile << 8, to_next: 0, to_second: 0, ends: 0 }];
    }
    let stride = stride.clamp(1, segments);
    let next = (2 * stride).min(segments);
    let tile_layer = |(layer, below): (u32, u32)| TileLayer {
        tile_and_layer: tile << 8 | layer,
        to_next: below,
        to_second: next.min(layer),
        ends: u32::from(!(segments - layer).is_multiple_of(next)),
    };
    drawn_layers(segments, stride).map(tile_layer).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remaining_layers_reach_down_to_the_next_one() {
        for segments in [1, 8, 16, 21, 64] {
            for stride in [1, 2, 4, 16, 128] {
                let layers = layers_of(3, segments, stride);
                let [to_next, to_second] = [stride, 2 * stride].map(|below| below.min(segments));
                assert_eq!(layers[0], TileLayer { tile_and_layer: 3 << 8 | segments, to_next, to_second, ends: 0 });
                let remain: Vec<_> = layers.iter().filter(|layer| layer.ends == 0).collect();
                let number = |layer: &TileLayer| layer.tile_and_layer & 255;
                assert!(remain.windows(2).all(|pair| number(pair[0]) - pair[0].to_second == number(pair[1])), "{layers:?}");
                assert_eq!(number(remain[remain.len() - 1]), remain[remain.len() - 1].to_second);
            }
        }
        assert_eq!(layers_of(2, 0, 4), [TileLayer { tile_and_layer: 2 << 8, to_next: 0, to_second: 0, ends: 0 }]);
    }
}
