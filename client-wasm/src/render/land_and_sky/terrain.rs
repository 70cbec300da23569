//! Ground: the tiles of a quadtree, which all share one small mesh. Plain tiles and blocks of tiles, of one kind of grass without bare soil, have
//! cheaper pipelines.

use crate::render::gpu::constants::{LITTER_END_M, TILE_CELLS};
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{DrawDescriptor, PassFactory, bind, storage};
use crate::render::gpu::shaders;
use crate::render::gpu::variants::LampVariants;
use crate::render::inputs::bend_atlas::BentPatches;
use crate::render::land_and_sky::plain_ground::PlainGround;
use crate::render::land_and_sky::terrain_quadtree::{GroundTile, TILE_LIMIT, TerrainQuadtree};
use crate::state::DecodedScene;
use glam::{Vec2, Vec3};
use std::ops::Range;

pub(crate) struct Terrain {
    /// Pipelines by [`TileClass`].
    pipelines: LampVariants<[wgpu::RenderPipeline; CLASSES.len()]>,
    extent_m: Vec2,
    pub(crate) plain: PlainGround,
    indices: wgpu::Buffer,
    tiles: wgpu::Buffer,
    pub(crate) runs: Vec<Run>,
    group: wgpu::BindGroup,
}

/// What the pixels of a tile may show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum TileClass {
    /// One kind of grass, beyond [`LITTER_END_M`], which only the wind bends.
    Still,
    /// The same where part of it is beyond the edge of the map, whose cover continues there.
    StillBeyond,
    /// The same within the map where the bend field may be other than 0.
    Plain,
    /// Anything on the map.
    Mixed,
    /// Also what is beyond its edge.
    Beyond,
}

pub(crate) const CLASSES: [TileClass; 5] =
    [TileClass::Still, TileClass::StillBeyond, TileClass::Plain, TileClass::Mixed, TileClass::Beyond];

/// Blocks along each side of a tile. The blocks of a tile that is not plain as a whole are classified one by one.
const BLOCKS: u32 = 4;
const BLOCK_CELLS: u32 = TILE_CELLS / BLOCKS;
const BLOCK_INDICES: u32 = 6 * BLOCK_CELLS.pow(2);
/// Maximum number of instances: tiles, and blocks of mixed ones.
const INSTANCE_LIMIT: usize = 4 * TILE_LIMIT;

/// One draw call: the same block, or the whole, of tiles of a class.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    pub(crate) class: TileClass,
    indices: Range<u32>,
    pub(crate) tiles: Range<u32>,
}

impl Run {
    fn vertices(&self) -> u64 {
        let cells = if self.indices.len() as u32 == BLOCK_INDICES { BLOCK_CELLS } else { TILE_CELLS };
        u64::from((cells + 1).pow(2)) * self.tiles.len() as u64
    }
}

impl Terrain {
    /// The ground pass for a scene whose map is divided by this quadtree.
    pub(crate) fn new(factory: &PassFactory, decoded: &DecodedScene, quadtree: &TerrainQuadtree) -> Self {
        let layout = factory.layout("terrain", &[storage(0)]);
        let size = (INSTANCE_LIMIT * size_of::<GroundTile>()) as u64;
        let tiles = factory.gpu.empty_buffer("tiles", size, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST);
        let group = bind(&factory.gpu, "terrain", &layout, &[tiles.as_entire_binding()]);
        let indices = factory.gpu.buffer("tile", bytemuck::cast_slice(&tile_indices()), wgpu::BufferUsages::INDEX);
        let pipelines = pipelines(factory.clone(), layout);
        Self {
            pipelines,
            extent_m: decoded.scene().extent_m().into(),
            plain: PlainGround::new(decoded, quadtree.finest_m() / BLOCKS as f32),
            indices,
            tiles,
            runs: Vec::new(),
            group,
        }
    }

    /// Classifies the tiles in view, of which the bend field bends those of `bent`.
    pub(crate) fn prepare(&mut self, gpu: &Gpu, eye_m: Vec3, tiles: &[GroundTile], bent: &BentPatches) {
        let mut instances = Vec::with_capacity(tiles.len());
        for (number, tile) in tiles.iter().enumerate() {
            let (whole_class, whole) = self.classified(tile, eye_m, bent);
            let room = INSTANCE_LIMIT - instances.len() - (tiles.len() - number - 1);
            let first = instances.len();
            if whole_class >= TileClass::Mixed && room >= BLOCKS.pow(2) as usize {
                let blocks = (0..BLOCKS.pow(2)).map(|block| (block, self.classified(&tile.part(block, BLOCKS), eye_m, bent)));
                instances.extend(blocks.map(|(block, (class, part))| (class, Some(block), tile.with_kind(part.kind()))));
            }
            if instances[first..].iter().all(|(class, ..)| *class >= TileClass::Mixed) {
                instances.truncate(first);
                instances.push((whole_class, None, whole));
            }
        }
        instances.sort_by_key(|(class, block, _)| (*class, *block));
        let tiles: Vec<GroundTile> = instances.iter().map(|(.., tile)| *tile).collect();
        gpu.queue.write_buffer(&self.tiles, 0, bytemuck::cast_slice(&tiles));
        let mut end = 0;
        self.runs.clear();
        self.runs.extend(instances.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).map(|same| {
            let (class, block, _) = same[0];
            let (first, last) = block.map_or((0, BLOCKS.pow(2)), |block| (block, block + 1));
            let begin = end;
            end += same.len() as u32;
            Run { class, indices: first * BLOCK_INDICES..last * BLOCK_INDICES, tiles: begin..end }
        }));
    }

    fn classified(&self, tile: &GroundTile, eye_m: Vec3, bent: &BentPatches) -> (TileClass, GroundTile) {
        let is_within = tile.is_within(self.extent_m);
        let kind = self.plain.kind(tile.corner_m.into(), tile.side_m).filter(|_| tile.distances_m(eye_m)[0] > LITTER_END_M);
        let Some(kind) = kind else {
            return (if is_within { TileClass::Mixed } else { TileClass::Beyond }, *tile);
        };
        match (is_within, bent.touch(tile.corner_m, tile.side_m)) {
            (true, false) => (TileClass::Still, tile.with_kind(kind)),
            (true, true) => (TileClass::Plain, tile.with_kind(kind)),
            (false, false) => (TileClass::StillBeyond, tile.with_kind(kind)),
            (false, true) => (TileClass::Beyond, *tile),
        }
    }

    /// Creates a variant of a pipeline that no frame has needed yet. Returns false if there is none.
    pub(crate) fn create_next(&self) -> bool {
        self.pipelines.create_next()
    }

    /// Vertices that [`draw`](Self::draw) submits.
    pub(crate) fn vertices(&self) -> u64 {
        self.runs.iter().map(Run::vertices).sum()
    }

    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, has_lamps: bool) {
        pass.set_bind_group(1, &self.group, &[]);
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint16);
        let pipelines = self.pipelines.of(has_lamps);
        for runs in self.runs.chunk_by(|a, b| a.class == b.class) {
            pass.set_pipeline(&pipelines[runs[0].class as usize]);
            for run in runs {
                pass.draw_indexed(run.indices.clone(), 0, run.tiles.clone());
            }
        }
    }
}

/// Pipelines by [`TileClass`].
fn pipelines(factory: PassFactory, layout: wgpu::BindGroupLayout) -> LampVariants<[wgpu::RenderPipeline; CLASSES.len()]> {
    LampVariants::new(move |[lamps]| {
        // All share the vertex shader, so that they meet to the bit.
        let vertices = factory.shader("terrain", shaders::TERRAIN, &[]);
        CLASSES.map(|class| {
            let constants = [
                lamps,
                ("is_plain", class < TileClass::Mixed),
                ("has_bend", class >= TileClass::Plain),
                ("reaches_beyond", matches!(class, TileClass::StillBeyond | TileClass::Beyond)),
            ];
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

/// Two triangles per cell, anticlockwise as seen from above, block by block.
pub(crate) fn tile_indices() -> Vec<u16> {
    let row = TILE_CELLS as u16 + 1;
    let square = |side: u32| (0..side.pow(2)).map(move |at| [at % side, at / side]);
    let cells =
        square(BLOCKS).flat_map(|[x, z]| square(BLOCK_CELLS).map(move |cell| [x * BLOCK_CELLS + cell[0], z * BLOCK_CELLS + cell[1]]));
    cells
        .flat_map(|[x, z]| {
            let nw = z as u16 * row + x as u16;
            [nw, nw + row, nw + 1, nw + 1, nw + row, nw + row + 1]
        })
        .collect()
}
