//! Ground: the tiles of a quadtree, which all share one small mesh. Plain tiles, of one kind of grass without bare soil, have a cheaper pipeline.

use crate::render::gpu::constants::{LITTER_END_M, TILE_CELLS, TILE_VERTICES};
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{DrawDescriptor, PassFactory, bind, storage};
use crate::render::gpu::shaders;
use crate::render::gpu::variants::LampVariants;
use crate::render::land_and_sky::plain_ground::PlainGround;
use crate::render::land_and_sky::terrain_quadtree::{GroundTile, TILE_LIMIT, TerrainQuadtree};
use crate::state::DecodedScene;
use glam::{Vec2, Vec3};
use std::ops::Range;

pub(crate) struct Terrain {
    /// Pipelines by [`TileClass`].
    pipelines: LampVariants<[wgpu::RenderPipeline; 3]>,
    extent_m: Vec2,
    pub(crate) plain: PlainGround,
    indices: wgpu::Buffer,
    index_count: u32,
    tiles: wgpu::Buffer,
    /// Tiles of each class.
    pub(crate) ranges: [Range<u32>; 3],
    group: wgpu::BindGroup,
}

/// What the pixels of a tile may show.
#[derive(Clone, Copy, PartialEq, Eq)]
enum TileClass {
    /// One kind of grass, beyond [`LITTER_END_M`].
    Plain,
    /// Anything on the map.
    Mixed,
    /// Also what is beyond its edge.
    Beyond,
}

impl Terrain {
    /// The ground pass for a scene whose map is divided by this quadtree.
    pub(crate) fn new(factory: &PassFactory, decoded: &DecodedScene, quadtree: &TerrainQuadtree) -> Self {
        let layout = factory.layout("terrain", &[storage(0)]);
        let indices = tile_indices();
        let size = (TILE_LIMIT * size_of::<GroundTile>()) as u64;
        let tiles = factory.gpu.empty_buffer("tiles", size, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST);
        let group = bind(&factory.gpu, "terrain", &layout, &[tiles.as_entire_binding()]);
        let index_buffer = factory.gpu.buffer("tile", bytemuck::cast_slice(&indices), wgpu::BufferUsages::INDEX);
        let index_count = indices.len() as u32;
        let pipelines = pipelines(factory.clone(), layout);
        Self {
            pipelines,
            extent_m: decoded.scene().extent_m().into(),
            plain: PlainGround::new(decoded, quadtree.finest_m()),
            indices: index_buffer,
            index_count,
            tiles,
            ranges: Default::default(),
            group,
        }
    }

    pub(crate) fn prepare(&mut self, gpu: &Gpu, eye_m: Vec3, tiles: &[GroundTile]) {
        let mut sorted: [Vec<GroundTile>; 3] = Default::default();
        for tile in tiles {
            let (class, tile) = self.classified(tile, eye_m);
            sorted[class as usize].push(tile);
        }
        let mut end = 0;
        self.ranges = sorted.each_ref().map(|tiles| {
            let begin = end;
            end += tiles.len() as u32;
            begin..end
        });
        gpu.queue.write_buffer(&self.tiles, 0, bytemuck::cast_slice(&sorted.concat()));
    }

    fn classified(&self, tile: &GroundTile, eye_m: Vec3) -> (TileClass, GroundTile) {
        if !tile.is_within(self.extent_m) {
            return (TileClass::Beyond, *tile);
        }
        let kind = self.plain.kind(tile.corner_m.into(), tile.side_m).filter(|_| tile.distances_m(eye_m)[0] > LITTER_END_M);
        kind.map_or((TileClass::Mixed, *tile), |kind| (TileClass::Plain, tile.with_kind(kind)))
    }

    /// Creates a variant of a pipeline that no frame has needed yet. Returns false if there is none.
    pub(crate) fn create_next(&self) -> bool {
        self.pipelines.create_next()
    }

    /// Vertices that [`draw`](Self::draw) submits.
    pub(crate) fn vertices(&self) -> u64 {
        u64::from(self.ranges[2].end * TILE_VERTICES)
    }

    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, has_lamps: bool) {
        pass.set_bind_group(1, &self.group, &[]);
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint16);
        for (pipeline, tiles) in self.pipelines.of(has_lamps).iter().zip(self.ranges.clone()) {
            pass.set_pipeline(pipeline);
            pass.draw_indexed(0..self.index_count, 0, tiles);
        }
    }
}

/// Pipelines by [`TileClass`].
fn pipelines(factory: PassFactory, layout: wgpu::BindGroupLayout) -> LampVariants<[wgpu::RenderPipeline; 3]> {
    LampVariants::new(move |[lamps]| {
        // All share the vertex shader, so that they meet to the bit.
        let vertices = factory.shader("terrain", shaders::TERRAIN, &[]);
        [TileClass::Plain, TileClass::Mixed, TileClass::Beyond].map(|class| {
            let constants = [lamps, ("is_plain", class == TileClass::Plain), ("reaches_beyond", class == TileClass::Beyond)];
            let fragments = factory.shader("terrain", shaders::TERRAIN, &constants);
            let draw = DrawDescriptor {
                label: "terrain",
                cull: Some(wgpu::Face::Back),
                fragment_module: Some(&fragments),
                ..DrawDescriptor::default()
            };
            factory.draw(&vertices, Some(&layout), &draw)
        })
    })
}

/// Two triangles per cell, anticlockwise as seen from above.
pub(crate) fn tile_indices() -> Vec<u16> {
    let row = TILE_CELLS as u16 + 1;
    let cells = (0..TILE_CELLS as u16).flat_map(|z| (0..TILE_CELLS as u16).map(move |x| z * row + x));
    cells.flat_map(|nw| [nw, nw + row, nw + 1, nw + 1, nw + row, nw + row + 1]).collect()
}
