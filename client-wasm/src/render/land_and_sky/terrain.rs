//! Ground: a quadtree of tiles, finer near the camera, that all share one small mesh.

use crate::render::gpu::constants::{HILLS_FULL_M, HILLS_MEAN, HILLS_RANGE_M, HILLS_SLOPE, TILE_CELLS, TILE_VERTICES};
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{DrawDescriptor, PassFactory, bind, storage};
use crate::render::gpu::shaders;
use crate::render::gpu::variants::LampVariants;
use crate::render::inputs::frustum::Frustum;
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3, Vec3Swizzles};

/// Maximum number of tiles in a frame.
const TILE_LIMIT: usize = 1024;
/// Bounds of the hills beyond the edge of the map, relative to the map (m).
const HILLS_M: [f32; 2] = [-90.0, 160.0];
/// Distance at which a coarser tile takes over, relative to the side of a tile.
const RANGE_SIDES: f32 = 2.6;

/// A leaf of the quadtree, as in `ground_tile.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct GroundTile {
    /// North-west corner, X and Z (m).
    pub(crate) corner_m: [f32; 2],
    pub(crate) side_m: f32,
    /// Distance at which the next coarser grid takes over (m).
    coarser_from_m: f32,
}

impl GroundTile {
    /// Smallest and largest horizontal distance from a position (m).
    pub(crate) fn distances_m(&self, at_m: Vec3) -> [f32; 2] {
        let low = Vec2::from(self.corner_m) - Vec2::new(at_m.x, at_m.z);
        let high = low + self.side_m;
        [low.max(-high).max(Vec2::ZERO).length(), low.abs().max(high.abs()).length()]
    }

    /// Whether all of it lies on a map of this extent.
    fn is_within(&self, extent_m: Vec2) -> bool {
        let low = Vec2::from(self.corner_m);
        low.cmpge(Vec2::ZERO).all() && (low + self.side_m).cmple(extent_m).all()
    }
}

/// Quadtree over the map and its surroundings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TerrainQuadtree {
    corner_m: Vec2,
    side_m: f32,
    finest_m: f32,
    extent_m: Vec2,
    /// Lowest and highest point of the map.
    height_m: [f32; 2],
    /// Maximum height of the grass.
    grass_m: f32,
}

impl TerrainQuadtree {
    /// Quadtree for a map of `extent_m` with pixels of `pixel_m`, heights within `height_m` and grass up to `grass_m`, and the visible hills beyond its edge.
    pub(crate) fn new(extent_m: [f32; 2], pixel_m: [f32; 2], height_m: [f32; 2], grass_m: f32, haze_m: f32) -> Self {
        let pixel = pixel_m[0].min(pixel_m[1]).clamp(1.0, 16.0);
        let finest_m = TILE_CELLS as f32 * pixel.log2().round().exp2();
        let beyond_m = (4.0 * haze_m).clamp(500.0, 8_000.0);
        let wanted = extent_m[0].max(extent_m[1]) + 2.0 * beyond_m;
        let mut side_m = finest_m;
        while side_m < wanted {
            side_m *= 2.0;
        }
        let corner_m = 0.5 * (Vec2::from(extent_m) - Vec2::splat(side_m));
        // Aligned to the finest tiles, so that the corner of the map is a vertex.
        let corner_m = (corner_m / finest_m).floor() * finest_m;
        Self { corner_m, side_m, finest_m, extent_m: extent_m.into(), height_m, grass_m }
    }

    /// The same square with finest tiles of at most `finest_m`.
    pub(crate) fn finer(&self, finest_m: f32) -> Self {
        Self { finest_m: finest_m.min(self.finest_m), ..*self }
    }

    /// Tiles in view, nearest first.
    pub(crate) fn tiles(&self, eye_m: Vec3, frustum: &Frustum) -> Vec<GroundTile> {
        let mut tiles = Vec::new();
        self.collect(self.corner_m, self.side_m, eye_m, frustum, &mut tiles);
        let distance =
            |tile: &GroundTile| (Vec2::from(tile.corner_m) + 0.5 * tile.side_m - Vec2::new(eye_m.x, eye_m.z)).length() - 0.7 * tile.side_m;
        tiles.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        tiles.truncate(TILE_LIMIT);
        tiles
    }

    fn collect(&self, corner: Vec2, side: f32, eye: Vec3, frustum: &Frustum, tiles: &mut Vec<GroundTile>) {
        let tile = GroundTile { corner_m: corner.into(), side_m: side, coarser_from_m: RANGE_SIDES * side };
        let [lowest, highest] = self.height_m;
        let between = |[below, above]: [f32; 2]| [corner.extend(lowest + below).xzy(), (corner + side).extend(highest + above).xzy()];
        let outside_m = (-corner).max(corner + side - self.extent_m).max(Vec2::ZERO).length();
        let [low, high] = between(hills_m(outside_m));
        if !frustum.sees_box(low, high + self.grass_m * Vec3::Y) {
            return;
        }
        let [low, high] = between(HILLS_M);
        let nearest = eye.clamp(low, high);
        let finer_side = 0.5 * side;
        if side > self.finest_m && eye.distance(nearest) < RANGE_SIDES * finer_side {
            for (x, z) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
                self.collect(corner + finer_side * Vec2::new(x, z), finer_side, eye, frustum, tiles);
            }
        } else {
            tiles.push(tile);
        }
    }
}

/// Bounds of the hills up to a distance from the edge of the map, relative to the map (m): those of `far_hills` in WGSL.
pub(crate) fn hills_m(outside_m: f32) -> [f32; 2] {
    let fraction = (outside_m / HILLS_FULL_M).min(1.0);
    let rise = fraction * fraction * (3.0 - 2.0 * fraction);
    [-HILLS_MEAN * HILLS_RANGE_M * rise, ((1.0 - HILLS_MEAN) * HILLS_RANGE_M + HILLS_SLOPE * outside_m) * rise]
}

pub(crate) struct Terrain {
    /// Pipelines for tiles on the map, and for those that reach beyond its edge.
    pipelines: LampVariants<[wgpu::RenderPipeline; 2]>,
    extent_m: Vec2,
    indices: wgpu::Buffer,
    index_count: u32,
    tiles: wgpu::Buffer,
    /// Number of tiles on the map, and of all tiles.
    ends: [u32; 2],
    group: wgpu::BindGroup,
}

impl Terrain {
    /// The ground pass for a map of `extent_m`.
    pub(crate) fn new(factory: &PassFactory, extent_m: [f32; 2]) -> Self {
        let layout = factory.layout("terrain", &[storage(0)]);
        let indices = tile_indices();
        let size = (TILE_LIMIT * size_of::<GroundTile>()) as u64;
        let tiles = factory.gpu.empty_buffer("tiles", size, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST);
        let group = bind(&factory.gpu, "terrain", &layout, &[tiles.as_entire_binding()]);
        let index_buffer = factory.gpu.buffer("tile", bytemuck::cast_slice(&indices), wgpu::BufferUsages::INDEX);
        let index_count = indices.len() as u32;
        let pipelines = pipelines(factory.clone(), layout);
        Self { pipelines, extent_m: extent_m.into(), indices: index_buffer, index_count, tiles, ends: [0; 2], group }
    }

    pub(crate) fn prepare(&mut self, gpu: &Gpu, tiles: &[GroundTile]) {
        let (mut sorted, beyond): (Vec<GroundTile>, Vec<GroundTile>) = tiles.iter().partition(|tile| tile.is_within(self.extent_m));
        self.ends = [sorted.len() as u32, tiles.len() as u32];
        sorted.extend(beyond);
        gpu.queue.write_buffer(&self.tiles, 0, bytemuck::cast_slice(&sorted));
    }

    /// Creates a variant of a pipeline that no frame has needed yet. Returns false if there is none.
    pub(crate) fn create_next(&self) -> bool {
        self.pipelines.create_next()
    }

    /// Vertices that [`draw`](Self::draw) submits.
    pub(crate) fn vertices(&self) -> u64 {
        u64::from(self.ends[1] * TILE_VERTICES)
    }

    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, has_lamps: bool) {
        pass.set_bind_group(1, &self.group, &[]);
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint16);
        let [within, all] = self.ends;
        for (pipeline, tiles) in self.pipelines.of(has_lamps).iter().zip([0..within, within..all]) {
            pass.set_pipeline(pipeline);
            pass.draw_indexed(0..self.index_count, 0, tiles);
        }
    }
}

/// Pipelines for tiles on the map, and for those that reach beyond its edge.
fn pipelines(factory: PassFactory, layout: wgpu::BindGroupLayout) -> LampVariants<[wgpu::RenderPipeline; 2]> {
    LampVariants::new(move |[lamps]| {
        // Both share the vertex shader, so that they meet at the edge of the map to the bit.
        let vertices = factory.shader("terrain", shaders::TERRAIN, &[]);
        [false, true].map(|beyond| {
            let fragments = factory.shader("terrain", shaders::TERRAIN, &[lamps, ("reaches_beyond", beyond)]);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;

    #[test]
    fn tiles_within_the_map_are_distinguished_from_those_beyond_its_edge() {
        let extent_m = Vec2::new(100.0, 64.0);
        let is_within = |x: f32, z: f32| GroundTile { corner_m: [x, z], side_m: 16.0, coarser_from_m: 0.0 }.is_within(extent_m);
        assert!(is_within(0.0, 0.0) && is_within(80.0, 48.0) && is_within(84.0, 48.0), "on it, up to its edge");
        assert!(!is_within(-16.0, 0.0) && !is_within(-1.0, 16.0) && !is_within(16.0, -1.0), "west and north of it");
        assert!(
            !is_within(96.0, 16.0) && !is_within(84.5, 16.0) && !is_within(16.0, 49.0) && !is_within(200.0, 16.0),
            "east and south of it"
        );
    }

    #[test]
    fn tiles_of_the_map_are_visible_where_ground_or_grass_is() {
        let ground = TerrainQuadtree::new([256.0; 2], [1.0; 2], [0.0, 4.0], 1.0, 900.0);
        // A camera high over the map sees no near tiles when level, and some when it looks down.
        let seen = |pitch_rad: f32| {
            let camera = Camera { eye_m: Vec3::new(128.0, 100.0, 250.0), pitch_rad, ..Camera::default() };
            let tiles = ground.tiles(camera.eye_m, &Frustum::new(&camera.projection_from_world(1.7)));
            let is_near = |tile: &&GroundTile| tile.is_within(Vec2::splat(256.0)) && tile.distances_m(camera.eye_m)[1] < 100.0;
            tiles.iter().filter(is_near).count()
        };
        assert_eq!(seen(0.0), 0);
        assert!(seen(-1.0) > 2, "{}", seen(-1.0));
    }

    #[test]
    fn tiles_cover_the_view_exactly_once() {
        for (extent, pixel) in [([256.0, 256.0], [1.0, 1.0]), ([30_000.0, 22_000.0], [74.0, 92.0])] {
            let ground = TerrainQuadtree::new(extent, pixel, [0.0, 40.0], 2.0, 900.0);
            let eye_m = Vec3::new(extent[0] * 0.4, 20.0, extent[1] * 0.6);
            let camera = Camera { eye_m, heading_rad: 0.8, ..Camera::default() };
            let matrix = camera.projection_from_world(1.7);
            let tiles = ground.tiles(eye_m, &Frustum::new(&matrix));
            assert!(tiles.len() < 300, "{} tiles", tiles.len());
            for fraction in [0.01, 0.05, 0.2, 0.7] {
                let p = eye_m + camera.forward() * extent[0] * fraction;
                let holds = |tile: &&GroundTile| {
                    let [x, z] = tile.corner_m;
                    (x..x + tile.side_m).contains(&p.x) && (z..z + tile.side_m).contains(&p.z)
                };
                assert_eq!(tiles.iter().filter(holds).count(), 1, "{p}");
            }
        }
    }
}
